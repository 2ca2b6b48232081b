// Colours of the drawings in light and dark, told apart by the colour of the text around them.

const LIGHT = {
  text: "#1c2733", faint: "#8896a5", grid: "#dfe5ea", panel: "#f6f8fa", mark: "#b8c2cc",
  axes: ["#0072b2", "#d55e00", "#00805f"], body: [98, 128, 158], pad: [70, 84, 98],
  pressed: [213, 60, 0], wall: [150, 162, 174], plate: [190, 198, 206], thrust: "#c2185b", mass: "#6a3fb5",
};
const DARK = {
  text: "#e4e9ee", faint: "#8a97a4", grid: "#333d47", panel: "#1a2026", mark: "#56616c",
  axes: ["#56b4e9", "#f0924c", "#2fc79a"], body: [104, 140, 176], pad: [176, 188, 200],
  pressed: [255, 110, 50], wall: [128, 140, 152], plate: [136, 146, 156], thrust: "#ff6f9f", mass: "#b79cff",
};
const pixel = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
const known = new Map(); // text colour as the browser writes it, which may be of any colour space

function colours(element) {
  const text = getComputedStyle(element).color;
  if (!known.has(text)) {
    pixel.fillStyle = text;
    pixel.fillRect(0, 0, 1, 1);
    const [red, green, blue] = pixel.getImageData(0, 0, 1, 1).data;
    known.set(text, red + green + blue > 384 ? DARK : LIGHT);
  }
  return known.get(text);
}

const shade = ([red, green, blue], light, opacity = 1) =>
  `rgba(${red * light | 0},${green * light | 0},${blue * light | 0},${opacity})`;

const mix = (from, to, share) => from.map((item, i) => item + (to[i] - item) * share);

// A canvas as large as its place on the page, sharp on every screen.
function sheet(canvas) {
  const { clientWidth: width, clientHeight: height } = canvas, ratio = devicePixelRatio || 1;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.lineJoin = "round";
  return { pen, width, height };
}
