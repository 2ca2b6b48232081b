"""Run the surrogate on thousands to millions of varied cases; writes ensemble.json and a zarr
store.

A file of errors states what varies, and cases, seed and sampling:

  cases = 10000
  seed = 1

  \\[vary."payload.mass"]
  distribution = "normal"
  mean = "9.9 kg"
  sd = "20 g"

\\[factor."thrust.peak"] is a factor of the value of the scene, and an offset has the keys axial and
radial, or y and z. Other distributions: fixed (value), uniform and log-uniform (low, high), truncated-normal (mean,
sd, low, high, rule "redraw" or "clip") and rayleigh (scale). A table has dotted keys in its
first line, units in the second or in each cell, and one case in every further line.

  tipoff ensemble --cases 1000000
  tipoff ensemble --vary my_errors.toml --cases 4096
  tipoff ensemble --vary my_errors.toml --limit "5 deg/s" --halve    # which tolerance to tighten
  tipoff ensemble --table cases.csv --store out/night
  tipoff ensemble --cases 1000000 --case 1234    # that case alone, compared with the store
  tipoff ensemble --sensitivity                  # count the sensitive cases too

After an interruption or a full disk, the same command continues and gives the same bits. A case
with bad input is refused, and the others run; the store lists it with its inputs and the reason
(done/*.json). xarray.open_zarr(STORE + "/cases.zarr") reads the results.

--halve halves each tolerance in turn. All cases keep their draws, so the changes have small bounds. The
figure halved.png is in the folder of the results.

--sensitivity adds the variables rate_change_by_clearance and rate_change_by_tolerance (rad/s),
also to an existing store. They are NaN if the case or its disturbed run does not settle. The
change by clearance is 0 for a case without contact.
"""

from tipoff.studies.commands.declared import command
from tipoff.studies.commands.request import Request
from tipoff.studies.commands.running import Output
from tipoff.studies.ensemble.options import EnsembleOptions
from tipoff.studies.question import Entry


def _answer(request: Request, options: EnsembleOptions) -> Output:
    from tipoff.studies.ensemble import page, stage
    from tipoff.workspace import models

    models.require(options.chosen)
    study = request.study()
    if options.case is None:
        found = stage.run(study, options)
        return Output(found.plain, lambda _: page.summary(found), request.out)
    options.require_one()
    one = stage.case(study, options, options.case)
    return Output(one.plain, lambda _: page.case(one))


ENTRY = Entry((command("ensemble", __doc__, EnsembleOptions, _answer),))
