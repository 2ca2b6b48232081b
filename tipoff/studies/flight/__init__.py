"""Compute the flight of the payload in orbit: miss distance, pointing error, coning, and
clearance to the platform.

Runs every condition and many cases with random errors; writes flight.json, flight.nc and
figures. The scene defines the orbit and the target:

  \\[flight]
  altitude = "500 km"
  range = "100 m"

azimuth, elevation and roll turn the launch axis out of the flight direction. --set replaces
values of the table:

  tipoff flight --set flight.range="1 km" --cases 10000
  tipoff flight --scene my_launcher.toml --set flight.altitude="600 km" --set flight.elevation="90 deg"
"""

from tipoff.studies.flight.options import FlightCommand
from tipoff.studies.question import Question

QUESTION = Question(__name__, __doc__, "After separation", "Flight", FlightCommand)
