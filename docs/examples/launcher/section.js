// The errors across the axis, seen from the open end: Y to the right, Z up. Misalignment is an arrow to
// its clock angle; the line of the thrust and the mass centre are points with a scale in mm.

const ROUND = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];

const across = ([, y, z]) => Math.hypot(y, z);
const tilt = ({ direction }) => Math.atan2(across(direction), direction[0]) * 180 / Math.PI;
const above = (value) => ROUND.find((item) => item >= value * (1 - 1e-6)) || Number(value.toPrecision(2));

// What the radius of the ring stands for: mm of a point, deg of the arrow.
const sectionScales = (loads) => ({ ring: above(Math.max(across(loads.line), across(loads.mass))), arrow: above(tilt(loads)) });

function drawSection(canvas, loads, look) {
  const { pen, width, height } = sheet(canvas), centre = [width / 2, height / 2 + 8];
  const radius = Math.min(width - 24, height - 16) / 2 - 16, { ring, arrow: most } = sectionScales(loads);
  pen.font = "12px system-ui, sans-serif";
  pen.textBaseline = "middle";
  dial(pen, centre, radius, look);
  const at = ([, y, z], length) => [centre[0] + y * length, centre[1] - z * length];
  const sine = across(loads.direction);
  if (sine > 0) arrow(pen, centre, at(loads.direction, radius * tilt(loads) / most / sine), look.thrust, 2.5);
  cross(pen, at(loads.line, radius / ring), look.thrust);
  pen.fillStyle = look.mass;
  pen.beginPath();
  pen.arc(...at(loads.mass, radius / ring), 4.5, 0, 7);
  pen.fill();
}

function dial(pen, centre, radius, look) {
  pen.strokeStyle = look.mark;
  pen.lineWidth = 1;
  pen.beginPath();
  pen.arc(...centre, radius, 0, 2 * Math.PI);
  for (let i = 0; i < 12; i++) {
    const [x, y] = [Math.cos(i * Math.PI / 6), Math.sin(i * Math.PI / 6)], inner = i % 3 ? 0.94 : -1;
    pen.moveTo(centre[0] + x * radius * inner, centre[1] + y * radius * inner);
    pen.lineTo(centre[0] + x * radius, centre[1] + y * radius);
  }
  pen.stroke();
  pen.textAlign = "center";
  for (const [name, x, y, axis] of [["+Y", 1, 0, 1], ["+Z", 0, -1, 2]]) {
    pen.fillStyle = look.axes[axis];
    pen.fillText(name, centre[0] + x * (radius + 13), centre[1] + y * (radius + 10));
  }
}

function cross(pen, [x, y], colour) {
  pen.strokeStyle = colour;
  pen.lineWidth = 2;
  pen.beginPath();
  pen.moveTo(x - 5, y - 5);
  pen.lineTo(x + 5, y + 5);
  pen.moveTo(x - 5, y + 5);
  pen.lineTo(x + 5, y - 5);
  pen.stroke();
}
