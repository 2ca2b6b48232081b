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
  <p data-name="error"></p>
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

function write(root, { answer, is_final }, kept) {
  const put = (name, text) => (root.querySelector(`[data-name="${name}"]`).textContent = text);
  const settled = answer.rate !== null;
  AXES.forEach((axis, i) => {
    put(`rate-${axis}`, said(settled ? answer.rate[i] : null, 3));
    put(`velocity-${axis}`, said(settled ? answer.velocity[i] : null, 4));
    put(`change-${axis}`, settled && kept && kept.rate ? signed(answer.rate[i] - kept.rate[i], 3) : "");
  });
  root.classList.toggle("comparing", Boolean(kept));
  root.classList.toggle("preliminary", !is_final);
  put("status", settled
    ? `Leaves the rails ${answer.exit_ms.toFixed(2)} ms after ignition, ${answer.off_axis.toFixed(3)} deg off the axis.`
    : `${answer.status}: no settled rates. ${answer.message}`);
}

// How far the rates can be trusted; ``found`` is empty until the sliders rest.
function writeError(root, { answer, is_final }, found) {
  const place = root.querySelector('[data-name="error"]'), waits = is_final ? "The error is being found." : "Rails without inertia, until the slider rests.";
  place.classList.toggle("sensitive", Boolean(found && found.is_sensitive));
  place.textContent = answer.rate === null ? "" : is_final && found ? `Error of the rates: ${found.words}.` : waits;
}
