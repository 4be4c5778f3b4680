// The worker of a live scene: it owns the engine, answers the page, and keeps checkpoints to undo edits.
import { load, Simulation } from 'dartcast';

const mostUndone = 8;
let scene, sim, middle, sent, saved = [], contacts = [];

const centred = (values) => Float32Array.from(values, (x, i) => x - middle[i % 3]);

/** What the page draws. Triangles go along after an edit alone. */
function moment(ms = 0) {
  const walls = sim.walls();
  const isNew = walls.version !== sent;
  sent = walls.version;
  return {
    time: sim.time, steps: sim.steps, ms, count: sim.positions().length / 3, canUndo: saved.length > 0,
    positions: centred(sim.positions()), speeds: Float32Array.from(sim.speeds()), contacts: centred(contacts),
    walls: { points: centred(walls.points), faces: isNew ? { corners: walls.triangles, patch: walls.patches } : null },
    solids: [{ kind: 'catheter', name: 'c', radius: 5e-4, points: centred(sim.catheter()) }],
  };
}

function edit(make) {
  const before = sim.checkpoint();
  make();
  saved = [...saved.slice(1 - mostUndone), before];
  contacts = [];
  return moment();
}

const answers = {
  async start(given) {
    await load(given.wasm, (text) => postMessage({ progress: text }));
    postMessage({ progress: 'Making the scene …' });
    scene = given.scene;
    sim = new Simulation(scene);
    const { points } = sim.walls();
    const box = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    points.forEach((x, i) => {
      box[0][i % 3] = Math.min(box[0][i % 3], x);
      box[1][i % 3] = Math.max(box[1][i % 3], x);
    });
    middle = [0, 1, 2].map((k) => (box[0][k] + box[1][k]) / 2);
    return { ...moment(), box, dimension: 3, patches: ['', 'wall', 'inlet', 'outlet_left', 'outlet_right', 'outer'], gravity: scene.motion.gravity ?? [0, 0, 0], offers: ['cut', 'tie', 'pull'] };
  },
  run({ steps, steer }) {
    const began = performance.now();
    contacts = [];
    for (let i = 0; i < steps; ++i) {
      if (steer) sim.steer(0, steer);
      sim.step();
      contacts.push(...sim.contacts());
    }
    return moment((performance.now() - began) / steps);
  },
  cut: (disc) => edit(() => sim.cut(disc)),
  tie: (plane) => edit(() => sim.tie(plane)),
  pull: (given) => edit(() => sim.pull(given)),
  undo() {
    sim.restore(saved.pop());
    sent = null;
    return moment();
  },
  again() { saved = []; sim.delete(); sim = new Simulation(scene); sent = null; return moment(); },
  memory: () => sim.memory(),
  hash: () => ({ hash: sim.stateHash(), steps: sim.steps }),
  audit: () => ({ ...sim.audit(), steps: sim.steps }),
  compare({ steps }) {
    const other = new Simulation(scene);
    for (let i = 0; i < steps; ++i) other.step();
    return { hash: other.stateHash() };
  },
};

onmessage = async ({ data: { id, what, argument } }) => {
  try {
    const value = await answers[what](argument);
    const buffers = value.positions ? [value.positions.buffer] : [];
    postMessage({ id, value }, buffers);
  } catch (error) {
    postMessage({ id, error: error.message });
  }
};
