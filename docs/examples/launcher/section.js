// The errors across the axis, seen from the open end: Y to the right, Z up. Misalignment is an arrow to
// its clock angle; the line of the thrust and the mass centre are points with a scale in mm.

const ROUND = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];

function drawSection(canvas, loads, look) {
  const { pen, width, height } = sheet(canvas), centre = [width / 2, height / 2 + 8];
  const radius = Math.min(width, height - 16) / 2 - 22;
  const largest = Math.max(Math.hypot(loads.line[1], loads.line[2]), Math.hypot(loads.mass[1], loads.mass[2]));
  const scale = ROUND.find((item) => item >= largest) || largest;
  const tilt = Math.hypot(loads.direction[1], loads.direction[2]), degrees = Math.atan2(tilt, loads.direction[0]) * 180 / Math.PI;
  pen.font = "12px system-ui, sans-serif";
  pen.textBaseline = "middle";
  dial(pen, centre, radius, look);
  pen.textAlign = "left";
  pen.fillStyle = look.faint;
  pen.fillText(`ring: ${scale} mm`, 4, 10);
  const at = ([, y, z], length) => [centre[0] + y * length, centre[1] - z * length];
  if (tilt > 0) {
    const most = ROUND.find((item) => item >= degrees) || degrees;
    pen.textAlign = "right";
    pen.fillText(`arrow to the ring: ${most} deg`, width - 4, 10);
    arrow(pen, centre, at(loads.direction, radius * degrees / most / tilt), look.thrust, 2.5);
  }
  cross(pen, at(loads.line, radius / scale), look.thrust);
  pen.fillStyle = look.mass;
  pen.beginPath();
  pen.arc(...at(loads.mass, radius / scale), 4.5, 0, 7);
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
