// The elements of the view, and the numbers of a run as text.

const MARKUP = `<div class="body">
<div class="stage">
  <canvas class="space" role="img" aria-label="Payload, pads and rails. Drag to turn the view."></canvas>
  <div class="play">
    <button type="button" data-do="play">Pause</button>
    <input type="range" data-set="time" min="0" max="1000" value="0" aria-label="time after ignition">
    <output data-name="time"></output>
    <label>Motion across drawn <input type="range" data-set="factor" min="0" max="100" step="1" value="30"> <output data-name="factor"></output></label>
  </div>
</div>
<div class="side">
  <p class="status" data-name="status"></p>
  <table>
    <thead><tr><th></th><th>x</th><th>y</th><th>z</th><th></th></tr></thead>
    <tbody>
      <tr><th>exit rates</th><td data-name="rate-x"></td><td data-name="rate-y"></td><td data-name="rate-z"></td><td>deg/s</td></tr>
      <tr class="kept"><th>changed by</th><td data-name="change-x"></td><td data-name="change-y"></td><td data-name="change-z"></td><td>deg/s</td></tr>
      <tr><th>velocity</th><td data-name="velocity-x"></td><td data-name="velocity-y"></td><td data-name="velocity-z"></td><td>m/s</td></tr>
    </tbody>
  </table>
  <p data-name="uncertainty"></p>
  <div class="errors">
    <canvas class="section" role="img" aria-label="Errors across the axis, seen from the open end"></canvas>
    <p>Seen from the open end. Ring: <span data-name="ring"></span>. <span class="thrust">Arrow: tilt of the thrust, <span data-name="arrow"></span> at the ring. Cross: its line.</span> <span class="mass">Dot: mass centre.</span></p>
  </div>
  <button type="button" data-do="keep">Compare with this run</button>
</div>
<div class="charts">
  <figure><canvas role="img" aria-label="Angular rates over time"></canvas><i></i></figure>
  <figure><canvas role="img" aria-label="Velocity along the rails over time"></canvas><i></i></figure>
  <figure><canvas role="img" aria-label="Velocity across the rails over time"></canvas><i></i></figure>
</div></div>`;

const AXES = ["x", "y", "z"];
const said = (value, digits) => (value === null ? "–" : value.toFixed(digits).replace(/^-(0\.0+)$/, "$1"));
const signed = (value, digits) => (value < 0 ? "" : "+") + value.toFixed(digits);

function write(root, { answer, loads, is_final }, kept) {
  const put = (name, text) => (root.querySelector(`[data-name="${name}"]`).textContent = text);
  const settled = answer.rate !== null;
  AXES.forEach((axis, i) => {
    put(`rate-${axis}`, said(settled ? answer.rate[i] : null, 3));
    put(`velocity-${axis}`, said(settled ? answer.velocity[i] : null, 4));
    put(`change-${axis}`, settled && kept && kept.rate ? signed(answer.rate[i] - kept.rate[i], 3) : "");
  });
  root.classList.toggle("comparing", Boolean(kept));
  root.classList.toggle("preliminary", !is_final);
  const scales = sectionScales(loads);
  put("ring", `${scales.ring} mm`);
  put("arrow", `${scales.arrow} deg`);
  put("status", settled
    ? `Leaves the rails ${answer.exit_ms.toFixed(2)} ms after ignition, ${answer.off_axis.toFixed(3)} deg off the axis.`
    : `${answer.status}: no settled rates. ${answer.message}`);
}

// How far the rates can be trusted; ``found`` is empty until the sliders rest.
function writeUncertainty(root, { answer, is_final }, found) {
  const place = root.querySelector('[data-name="uncertainty"]');
  place.classList.remove("sensitive");
  if (answer.rate === null) return void (place.textContent = "");
  if (!is_final) return void (place.textContent = "Rails without inertia, until the slider rests.");
  if (!found) return void (place.textContent = "How far small changes move the rates is being found.");
  const parts = [["1 µm of clearance", found.by_clearance], ["a tolerance of 1e-10", found.by_tolerance]].map(([cause, change]) =>
    (change === null ? `${cause} prevents the run from settling` : `${cause} changes a rate by ±${change.toPrecision(2)} deg/s`));
  const sensitive = [found.by_clearance, found.by_tolerance].some((change) => change === null || change > answer.limit);
  place.classList.toggle("sensitive", sensitive);
  place.textContent = `${parts.join("; ")}. ${sensitive
    ? "Sensitive: use an ensemble in place of this single run."
    : "The model itself is compared with finite elements in the report."}`;
}
