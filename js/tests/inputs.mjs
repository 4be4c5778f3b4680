// node inputs.mjs PACKAGE REPLAY COUNT [SEED]: random scripts of inputs, run here and replayed by the native program REPLAY.
// The answer to each call must be the same: the state hash, or the error.
import {spawnSync} from "node:child_process";

const [folder, replay, count = "500", first = "1"] = process.argv.slice(2);
const {load, Simulation} = await import(`${folder}/dartcast.mjs`);
await load();

// Numbers from a seed (mulberry32).
function random_of(seed) {
  let a = seed >>> 0;
  return () => {
    a = (a + 0x6d2b79f5) >>> 0;
    let t = Math.imul(a ^ (a >>> 15), a | 1);
    t = (t + Math.imul(t ^ (t >>> 7), t | 61)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

const flat = (...points) => `[${points.join(", ")}]`;

// Scenes, each with the box that places of inputs are in, a length of inputs, and how many catheters and tools it has.
const scenes = [
  (r) => ({
    lines: [
      `environment = { generator = "vessel", core = 4, rings = 1, tissue_layers = 1, step_length = 1.4e-3 }`,
      `deformation = [{ kind = "pulse", amplitude = ${r() * 0.1}, period = 0.02, wavelength = 0.12, field = "pulse_direction", path = "path_length" },`,
      `  { kind = "bend", amplitude = ${r()}, period = 0.05, length = 0.06, axis = [0, 0, 1], direction = [0, 1, 0] }]`,
      `particles = [{ count = 40 }, { inlet = "inlet", rate = ${1e4 * r()} }]`,
      `catheter = [{ entry = [0.0, -0.006376, -0.026761], direction = [0.0, 0.472, 0.882], length = 0.03, spacing = 1e-3, stiffness = 1e-9, tip_length = 6e-3, tip_curvature = 120 }]`,
      `motion = { dt = 3e-4, gravity = [0, -9.81, 0], field = { array = "velocity", frame = "mesh" }, drag = ${r() < 0.5 ? 0 : 5000 * r()} }`,
      `contact = { response = "reflect", restitution = 0.5, patch = { outlet_left = { response = "escape" } } }`,
    ],
    low: [-0.006, -0.006, -0.03], high: [0.006, 0.006, 0.01], length: 2e-3, catheters: 1, tools: 0}),
  (r) => ({
    lines: [
      `environment = { generator = "box", cells = [5, 5, 6], type = "${["tetrahedron", "hexahedron", "prism", "mixed"][Math.floor(4 * r())]}", jitter = ${0.2 * r()}, blocked_layer = true, seed = ${Math.floor(1e6 * r())} }`,
      `deformation = [{ kind = "bend", amplitude = ${0.4 * r()}, period = 0.4, length = 8, axis = [0, 0, 1], direction = [1, 0, 0] }]`,
      `particles = [{ count = 60, velocity = [2, 3, 1]${r() < 0.5 ? ", radius = 0.05" : ""} }]`,
      ...(r() < 0.4 ? ["collisions = { restitution = 0.3 }"] : []),
      ...(r() < 0.3 ? [`body = [{ generator = "barrel", radius = 0.4, bulge = 0.1, height = 0.8, staves = 8, spacing = 0.25, at = [2.5, 2.5, 3], mass = 1.0 }]`] : []),
      `solid = [{ points = [[1.5, 1.5, 1.5], [1.8, 1.7, 2.2], [2.0, 1.4, 2.6]] }]`,
      `motion = { dt = 0.01, gravity = [0, 0, -9.81] }`,
      `contact = { response = "reflect", restitution = 0.7, friction = 0.1 }`,
    ],
    low: [0.5, 0.5, 0.5], high: [4.5, 4.5, 5.5], length: 0.4, catheters: 0, tools: 1}),
  (r) => ({
    lines: [
      `environment = { generator = "box", cells = [4, 4, 8], blocked_layer = true }`,
      `deformation = [{ kind = "twist", amplitude = ${r()}, period = 0.5, length = 8, centre = [2, 2, 4] }]`,
      `particles = [{ count = 60, velocity = [2, 3, 1] }]`,
      `catheter = [{ entry = [2.1, 2.2, 1.3], direction = [0, 0.1, 1], length = 4, spacing = 0.25, stiffness = 1.0, edges = ${r() < 0.7} }]`,
      `motion = { dt = 0.01, gravity = [0, 0, -9.81] }`,
      `contact = { response = "slide" }`,
    ],
    low: [0.5, 0.5, 0.5], high: [3.5, 3.5, 7.5], length: 0.4, catheters: 1, tools: 0}),
  (r) => ({
    lines: [
      `environment = { generator = "maze", rooms = [2, 2], seed = ${Math.floor(1e6 * r())} }`,
      `particles = [{ count = 60, velocity = [2, 3, 0] }]`,
      `motion = { dt = 0.02, gravity = [0, -9.81, 0] }`,
      `contact = { response = "reflect", restitution = 0.9 }`,
    ],
    low: [0, 0, 0], high: [16, 16, 0], length: 0.4, catheters: 0, tools: 0}),
];

function script_of(seed) {
  const r = random_of(seed);
  const scene = scenes[Math.min(Math.floor(r() * 4.5), 3)](r);
  const plane = scene.high[2] === 0;
  const place = () => scene.low.map((low, i) => low + r() * (scene.high[i] - low));
  const way = (size) => [0, 1, 2].map((i) => (plane && i === 2 ? 0 : (2 * r() - 1) * size));
  const calls = [["make", scene.lines.join("\t")]];
  const steps = () => ["step", String(1 + Math.floor(3 * r()))];
  const kinds = [
    [4, steps],
    [2 * scene.catheters, () => ["steer", `${r() < 0.95 ? 0 : 3} ${scene.length * (1.5 * r() - 0.5)} ${r() - 0.5}`]],
    [2 * scene.tools, () => ["steer_solid", `${r() < 0.95 ? 0 : 3} ${way(20 * scene.length).join(" ")} ${(r() < 0.5 ? [0, 0, 0] : way(3)).join(" ")}`]],
    [1, () => ["pull", [...place(), ...way(0.5 * scene.length), r() < 0.05 ? 0 : 3 * scene.length, 0.05].join(" ")]],
    [plane ? 0.1 : 1, () => ["edit", `event = [{ at = 0, kind = "cut", surface = "disc", point = ${flat(...place())}, normal = ${flat(...way(1))}, radius = ${scene.length * (1 + 3 * r())}, width = ${scene.length * 0.5} }]`]],
    [plane ? 0.1 : 1, () => ["edit", `event = [{ at = 0, kind = "carve", tool = "ball", point = ${flat(...place())}, radius = ${scene.length * 2}, what = "${r() < 0.8 ? "open" : "remove"}" }]`]],
    [0.5, () => ["edit", `event = [{ at = 0, kind = "ligature", point = ${flat(...place())}, normal = ${flat(...(plane ? [1, 0, 0] : [0, 0.2, 1]))}, draw = ${0.5 * r()}, reach = ${2 * scene.length}, duration = 0.05 }]`]],
    [1, () => ["add", `particles = [{ count = 5, velocity = ${flat(...way(1))} }]`]],
  ];
  const choose = () => {
    let left = r() * kinds.reduce((sum, [weight]) => sum + weight, 0);
    return kinds.find(([weight]) => (left -= weight) < 0)[1];
  };
  for (let i = 0; i < 14; ++i) calls.push(choose()());
  calls.push(["step", "2"]);
  return calls;
}

function run(calls) {
  let simulation;
  return calls.map(([name, text]) => {
    try {
      const v = text.split(" ").map(Number);
      if (name === "make") simulation = new Simulation(text.replaceAll("\t", "\n"));
      else if (name === "add") simulation.add(text);
      else if (name === "edit") simulation.edit(text);
      else if (name === "step") simulation.step(v[0]);
      else if (name === "steer") simulation.steer(v[0], {push: v[1], turn: v[2]});
      else if (name === "steer_solid") simulation.steerSolid(v[0], {velocity: v.slice(1, 4), turn: v.slice(4)});
      else simulation.pull({at: v.slice(0, 3), by: v.slice(3, 6), reach: v[6], duration: v[7]});
    } catch (error) {
      return error.message;
    }
    return simulation.stateHash();
  });
}

let answers = 0;
let refusals = 0;
for (let begin = 0; begin < Number(count); begin += 50) {
  const seeds = Array.from({length: Math.min(50, Number(count) - begin)}, (_, i) => Number(first) + begin + i);
  const scripts = seeds.map(script_of);
  const here = scripts.map(run);
  const native = spawnSync(replay, {input: scripts.flat().map((call) => `${call.join(" ")}\n`).join(""), encoding: "utf8", maxBuffer: 2 ** 28});
  if (native.status !== 0) throw new Error(`${replay} ended with ${native.status ?? native.signal}: ${native.stderr}`);
  const there = native.stdout.split("\n");
  scripts.forEach((calls, s) => calls.forEach((call, i) => {
    const other = there.shift();
    if (here[s][i] !== other) {
      console.error(`seed ${seeds[s]}, call ${i}: ${call.join(" ").replaceAll("\t", "\n")}\nhere   ${here[s][i]}\nnative ${other}`);
      process.exit(1);
    }
    if (/^[0-9a-f]{32}$/.test(other)) ++answers;
    else ++refusals;
    if (process.env.DARTCAST_SHOW && !/^[0-9a-f]{32}$/.test(other)) console.log(call[0], other);
  }));
}
console.log(`${count} scripts of inputs: ${answers} state hashes and ${refusals} errors are the same natively`);
