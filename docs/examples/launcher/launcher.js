// The launcher in axes of the platform at one instant. The motion across the rails and the clearance
// are drawn larger by one factor, so that a pad touches its wall in the drawing when it does in the run.

const COLUMN = { time: 0, place: 1, turn: 4, rate: 7, velocity: 10, thrust: 13, pads: 14 };

// The sample at a time (ms), between two rows in proportion.
function sampleAt(run, time) {
  const exact = Math.max(0, Math.min(run.count - 1, time / run.end * (run.count - 1)));
  const first = Math.min(run.count - 2, Math.floor(exact)), share = exact - first;
  const at = (column) => run.rows[first * run.width + column] * (1 - share) + run.rows[(first + 1) * run.width + column] * share;
  const three = (column) => [at(column), at(column + 1), at(column + 2)];
  return { place: three(COLUMN.place), turn: three(COLUMN.turn), rate: three(COLUMN.rate),
    velocity: three(COLUMN.velocity), thrust: at(COLUMN.thrust), pad: (i) => at(COLUMN.pads + i) };
}

function wallBoxes(shape, factor) {
  return shape.walls.map((wall) => {
    const middle = (shape.rail[0] + shape.rail[1]) / 2, length = (shape.rail[1] - shape.rail[0]) / 2;
    const centre = [middle, 0, 0], half = [length, 0, 0], other = 3 - wall.axis;
    const gap = factor * shape.gaps[wall.axis], outer = Math.abs(wall.across[0]) > Math.abs(wall.across[1]) ? 0 : 1;
    const across = [...wall.across];
    across[outer] += Math.sign(across[outer]) * (factor * shape.gaps[other] + shape.thickness);
    centre[wall.axis] = wall.face + wall.sign * (gap + shape.thickness / 2);
    half[wall.axis] = shape.thickness / 2;
    centre[other] = (across[0] + across[1]) / 2;
    half[other] = (across[1] - across[0]) / 2;
    const normal = [0, 0, 0];
    normal[wall.axis] = wall.sign;
    return { centre, half, normal };
  });
}

function drawWall(pen, camera, wall, shape, look, opacity) {
  box(pen, camera, { ...wall, colour: look.wall, opacity });
  const axis = wall.normal.findIndex((item) => item), sign = wall.normal[axis];
  for (const [start, end] of shape.mounts) { // where the platform holds the back of the wall
    const centre = [(start + end) / 2, wall.centre[1], wall.centre[2]], half = [(end - start) / 2, wall.half[1], wall.half[2]];
    centre[axis] += sign * (wall.half[axis] + 2);
    half[axis] = 2;
    box(pen, camera, { centre, half, colour: look.plate, opacity });
  }
}

// What encloses the launcher and the whole way of the payload (mm).
function bounds(run, factor) {
  const { shape } = run, far = run.farthest + shape.body[0] + 60;
  const rear = Math.min(-shape.body[0], shape.rail[0]) - 16;
  const reach = (axis) => Math.max(shape.body[axis], ...shape.walls.map((wall) => wall.axis === axis
    ? Math.abs(wall.face) + shape.thickness + factor * shape.gaps[axis] : 0)) + 10;
  return [[rear, -reach(1), -reach(2)], [Math.max(far, shape.rail[1]), reach(1), reach(2)]];
}

function drawLauncher(canvas, camera, run, time, factor, look) {
  const { pen, width, height } = sheet(canvas), { shape, loads } = run;
  const [low, high] = bounds(run, factor), now = sampleAt(run, time);
  camera.fit(low, high, width, height - 14);
  const turn = times(now.turn, factor), place = [now.place[0], factor * now.place[1], factor * now.place[2]];
  const pose = (point) => plus(place, turned(point, turn)), rotate = (direction) => turned(direction, turn);
  const plate = { centre: [low[0] + 4, 0, 0], half: [4, high[1] - 4, high[2] - 4], colour: look.plate };
  const inFront = (wall) => dot(wall.normal, camera.towards) > 0;
  const walls = wallBoxes(shape, factor).sort((a, b) => dot(a.centre, camera.towards) - dot(b.centre, camera.towards));
  if (camera.towards[0] >= 0) box(pen, camera, plate);
  // a wall lies outside the payload, so its normal tells which of both hides the other
  for (const wall of walls.filter((item) => !inFront(item))) drawWall(pen, camera, wall, shape, look, 1);
  const pads = shape.pads.map((pad, i) => ({ ...pad, force: now.pad(i) }));
  pads.sort((a, b) => dot(rotate(a.centre), camera.towards) - dot(rotate(b.centre), camera.towards));
  const body = { centre: [0, 0, 0], half: shape.body, colour: look.body, opacity: 0.94, pose, turn: rotate };
  const behind = (pad) => dot(rotate([0, pad.centre[1], pad.centre[2]]), camera.towards) < 0;
  const drawPad = (pad) => box(pen, camera, { ...pad, pose, turn: rotate,
    colour: mix(look.pad, look.pressed, Math.min(1, Math.sqrt(pad.force / run.largest))) });
  pads.filter(behind).forEach(drawPad);
  box(pen, camera, body);
  pads.filter((pad) => !behind(pad)).forEach(drawPad);
  for (const wall of walls.filter(inFront)) drawWall(pen, camera, wall, shape, look, 0.38);
  if (camera.towards[0] < 0) box(pen, camera, { ...plate, opacity: 0.3 });
  drawLoads(pen, camera, run, now, factor, pose, look);
  drawAxes(pen, camera, height, look);
}

// Thrust, as long as it acts, and the mass centre, with their errors drawn larger by the factor.
function drawLoads(pen, camera, run, now, factor, pose, look) {
  const { loads } = run, at = [-loads.arm, factor * loads.line[1], factor * loads.line[2]];
  const tilt = [loads.direction[0], factor * loads.direction[1], factor * loads.direction[2]];
  const length = 130 * now.thrust / run.peak / Math.hypot(...tilt);
  if (now.thrust > 0.02 * run.peak) arrow(pen, camera.place(pose(plus(at, times(tilt, -length)))), camera.place(pose(at)), look.thrust, 3);
  const [x, y] = camera.place(pose(times(loads.mass, factor)));
  pen.fillStyle = look.mass;
  pen.beginPath();
  pen.arc(x, y, 4.5, 0, 7);
  pen.fill();
}

function drawAxes(pen, camera, height, look) {
  const from = [34, height - 34];
  pen.font = "12px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  ["X", "Y", "Z"].forEach((name, i) => {
    const step = [camera.right[i] * 24, -camera.up[i] * 24];
    if (Math.hypot(...step) < 5) return; // it points at the reader
    arrow(pen, from, plus([...from, 0], [...step, 0]).slice(0, 2), look.axes[i], 1.6);
    pen.fillText(name, from[0] + step[0] * 1.4, from[1] + step[1] * 1.4);
  });
}
