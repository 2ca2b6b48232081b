// A parallel projection of boxes. X runs to the open end of the rails, Z up.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const times = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];

// Rodrigues: the vector turned by a rotation vector (rad).
function turned(vector, [x, y, z]) {
  const angle = Math.hypot(x, y, z);
  if (angle < 1e-12) return vector;
  const axis = [x / angle, y / angle, z / angle], cosine = Math.cos(angle), sine = Math.sin(angle);
  const cross = [axis[1] * vector[2] - axis[2] * vector[1], axis[2] * vector[0] - axis[0] * vector[2],
    axis[0] * vector[1] - axis[1] * vector[0]];
  return plus(plus(times(vector, cosine), times(cross, sine)), times(axis, dot(axis, vector) * (1 - cosine)));
}

class Camera {
  constructor() {
    this.reset();
  }

  reset() {
    this.turn(-0.5, 0.38);
  }

  turn(yaw, pitch) {
    this.yaw = yaw;
    this.pitch = Math.max(-1.5, Math.min(1.5, pitch));
    const [s, c, t, d] = [Math.sin(yaw), Math.cos(yaw), Math.sin(this.pitch), Math.cos(this.pitch)];
    this.right = [c, s, 0];
    this.up = [-s * t, c * t, d];
    this.towards = [s * d, -c * d, t]; // from the scene to the eye
  }

  // Fits the box between two corners into a sheet, whatever the direction of view.
  fit(low, high, width, height) {
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((k) => ((i >> k) & 1 ? high : low)[k]));
    const ends = (axis) => {
      const places = corners.map((corner) => dot(corner, axis));
      return [Math.min(...places), Math.max(...places)];
    };
    const [left, right] = ends(this.right), [bottom, top] = ends(this.up);
    this.scale = 0.94 * Math.min(width / (right - left), height / (top - bottom));
    this.left = width / 2 - this.scale * (left + right) / 2;
    this.top = height / 2 + this.scale * (bottom + top) / 2;
  }

  place(point) {
    return [this.left + this.scale * dot(point, this.right), this.top - this.scale * dot(point, this.up)];
  }
}

const SIDES = [[0, 1, 2], [0, -1, 2], [1, 1, 2], [1, -1, 2], [2, 1, 0], [2, -1, 0]];

// A box by its centre and half size. ``pose`` puts points and ``turn`` directions of its axes into the scene.
function box(pen, camera, { centre, half, colour, opacity = 1, pose = (p) => p, turn = (d) => d }) {
  for (const [axis, sign] of SIDES) {
    const normal = [0, 0, 0];
    normal[axis] = sign;
    const outward = turn(normal), facing = dot(outward, camera.towards);
    if (facing <= 1e-6) continue; // the far sides of a box are never seen
    const [first, second] = [0, 1, 2].filter((item) => item !== axis);
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) => {
      const point = [...centre];
      point[axis] += sign * half[axis];
      point[first] += a * half[first];
      point[second] += b * half[second];
      return camera.place(pose(point));
    });
    pen.beginPath();
    corners.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.closePath();
    pen.fillStyle = shade(colour, 0.72 + 0.3 * Math.max(0, outward[2]) + 0.12 * facing, opacity);
    pen.fill();
    pen.strokeStyle = shade(colour, 0.55, Math.min(1, opacity + 0.25));
    pen.lineWidth = 0.8;
    pen.stroke();
  }
}

function arrow(pen, from, to, colour, width = 2.5) {
  const angle = Math.atan2(to[1] - from[1], to[0] - from[0]), head = 4 + 2 * width;
  pen.strokeStyle = pen.fillStyle = colour;
  pen.lineWidth = width;
  pen.beginPath();
  pen.moveTo(...from);
  pen.lineTo(to[0] - 0.7 * head * Math.cos(angle), to[1] - 0.7 * head * Math.sin(angle));
  pen.stroke();
  pen.beginPath();
  pen.moveTo(...to);
  for (const side of [-0.42, 0.42]) pen.lineTo(to[0] - head * Math.cos(angle + side), to[1] - head * Math.sin(angle + side));
  pen.fill();
}
