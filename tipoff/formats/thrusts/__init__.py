"""Files with a thrust over time: tables, RASP (``.eng``) and RockSim (``.rse``)."""
