// Receives runs, plays the newest one, and says which run the reader rests at.

const SLOWER = 100; // times slower than the ejection
const RESTS = 300; // ms without a new run, after which its error is asked for
const CHARTS = [
  { title: "rates", unit: "deg/s", columns: [7, 8, 9], names: AXES, colours: [0, 1, 2], factor: 1 },
  { title: "velocity along", unit: "m/s", columns: [10], names: ["x"], colours: [0], factor: 1 },
  { title: "velocity across", unit: "mm/s", columns: [11, 12], names: ["y", "z"], colours: [1, 2], factor: 1e3 },
];

// A message with its samples as numbers, and what scales the drawing.
function received({ number, is_final, launcher, loads, answer, rows, width }) {
  const bytes = new Uint8Array(rows.buffer, rows.byteOffset, rows.byteLength).slice();
  const numbers = new Float32Array(bytes.buffer), count = numbers.length / width;
  let largest = 1, peak = 1e-9, farthest = 0;
  for (let i = 0; i < count; i++) {
    for (let k = COLUMN.pads; k < width; k++) largest = Math.max(largest, numbers[i * width + k]);
    peak = Math.max(peak, numbers[i * width + COLUMN.thrust]);
    farthest = Math.max(farthest, numbers[i * width + COLUMN.place]);
  }
  return { number, is_final, shape: launcher, loads, answer, rows: numbers, width, count, largest, peak, farthest,
    end: numbers[(count - 1) * width] };
}

function render({ model, el }) {
  const root = document.createElement("div");
  root.className = "ejection";
  root.innerHTML = MARKUP;
  el.append(root);
  const find = (query) => root.querySelector(query), camera = new Camera();
  const figures = [...root.querySelectorAll(".charts figure")];
  const state = { run: null, kept: null, time: 0, playing: !window.matchMedia("(prefers-reduced-motion: reduce)").matches, asked: 0, timer: 0 };

  const draw = (now) => {
    const passed = Math.min(100, now - state.last);
    state.asked = 0;
    state.last = now;
    if (!state.run || !root.isConnected || !root.clientWidth) return;
    if (state.playing) state.time = (state.time + (passed || 0) / SLOWER) % (state.run.end + 5); // rests at the end for half a second
    const time = Math.min(state.time, state.run.end), look = colours(el), factor = Number(find("[data-set=factor]").value);
    root.classList.toggle("dark", look === DARK);
    drawLauncher(find(".space"), camera, state.run, time, factor, look);
    if (state.stale || look !== state.look) {
      figures.forEach((figure, i) => drawChart(figure.firstChild, CHARTS[i], state.run, state.kept, look));
      Object.assign(state, { stale: false, look });
    }
    figures.forEach((figure) => moveCursor(figure, state.run, state.kept, time));
    if (state.playing) find("[data-set=time]").value = Math.round(1000 * time / state.run.end);
    find("[data-name=time]").textContent = `${time.toFixed(1)} ms`;
    find("[data-name=factor]").textContent = `${factor} times`;
    const drawn = `${state.run.number}${state.run.is_final ? " final" : ""}`;
    if (root.dataset.drawn !== drawn) root.dataset.drawn = drawn;
    if (state.playing) ask();
  };
  const ask = () => (state.asked ||= requestAnimationFrame(draw));
  const renew = () => ((state.stale = true), ask());
  const pause = (stop) => {
    state.playing = !stop;
    find("[data-do=play]").textContent = stop ? "Play" : "Pause";
    ask();
  };
  const show = () => {
    const message = model.get("shown");
    if (!message.rows) return;
    state.run = received(message);
    write(root, state.run, state.kept?.answer);
    tell();
    renew();
    clearTimeout(state.timer);
    if (!message.is_final) state.timer = setTimeout(() => {
      model.set("rested", message.number);
      model.save_changes();
    }, RESTS);
  };
  const tell = () => {
    const found = model.get("error");
    if (state.run) writeError(root, state.run, found.number === state.run.number ? found : null);
  };

  find("[data-do=play]").onclick = () => pause(state.playing);
  find("[data-set=time]").oninput = (event) => {
    state.time = event.target.value / 1000 * state.run.end;
    pause(true);
  };
  find("[data-set=factor]").oninput = ask;
  find("[data-do=keep]").onclick = () => {
    state.kept = state.kept ? null : state.run;
    find("[data-do=keep]").textContent = state.kept ? "End the comparison" : "Compare with this run";
    write(root, state.run, state.kept?.answer);
    renew();
  };
  find(".space").onpointerdown = (event) => event.target.setPointerCapture(event.pointerId);
  find(".space").onpointermove = (event) => {
    if (!event.buttons) return;
    camera.turn(camera.yaw + event.movementX / 150, camera.pitch + event.movementY / 150);
    ask();
  };
  find(".space").ondblclick = () => (camera.reset(), ask());
  const resized = new ResizeObserver(renew);
  resized.observe(root);
  model.on("change:shown", show);
  model.on("change:error", tell);
  pause(!state.playing);
  show();
  return () => {
    resized.disconnect();
    cancelAnimationFrame(state.asked);
    clearTimeout(state.timer);
    model.off("change:shown", show);
    model.off("change:error", tell);
  };
}

export default { render };
