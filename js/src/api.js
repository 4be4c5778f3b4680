// The JavaScript side of the engine; js/build.mjs puts it behind emscripten's createEngine(). index.d.ts is its contract.
// Each simulation has an instance of its own: so its memory is its whole state.

const arrays = ["positions", "velocities", "radii", "ids", "vertices", "wall_points", "solid_points", "catheter_frames", "contacts",
  "wall_triangles", "wall_patches", "wall_vertices", "solid_triangles"];
const first_of_integers = arrays.indexOf("wall_triangles");

let compiled = null;
let base = null;

/// Whether this machine runs the engine: (func (result v128) (i8x16.splat (i32.const 0))) and a tag are valid.
function is_supported() {
  const head = [0, 97, 115, 109, 1, 0, 0, 0];
  const simd = [...head, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 8, 1, 6, 0, 65, 0, 253, 15, 11];
  const tag = [...head, 1, 4, 1, 96, 0, 0, 13, 3, 1, 0, 0];
  return typeof WebAssembly === "object" && [simd, tag].every((code) => WebAssembly.validate(new Uint8Array(code)));
}

async function load(source) {
  if (compiled) return;
  if (!is_supported())
    throw new Error("dartcast needs WebAssembly with SIMD and exceptions: Chrome 95, Firefox 100, Safari 16.4, node 18, or newer");
  if (source instanceof WebAssembly.Module) {
    compiled = source;
    return;
  }
  let code = await source;
  if (code === undefined) {
    const place = new URL("dartcast.wasm", base);
    code = place.protocol === "file:" && typeof process === "object"
      ? await (await import("node:fs/promises")).readFile(place)
      : await (await fetch(place)).arrayBuffer();
  }
  compiled = await WebAssembly.compile(code);
}

function in_toml(value, place, put_file) {
  if (typeof value === "number")
    return Number.isSafeInteger(value) && !Object.is(value, -0) ? String(value)
      : Number.isFinite(value) ? (Object.is(value, -0) ? "-0.0" : value.toExponential()) : String(value).toLowerCase().slice(0, value < 0 ? 4 : 3);
  if (typeof value === "string") return JSON.stringify(value);
  if (typeof value === "boolean" || typeof value === "bigint") return String(value);
  if (value?.bytes !== undefined || value?.points?.buffer !== undefined) return JSON.stringify(put_file(value, place));
  if (Array.isArray(value) || ArrayBuffer.isView(value))
    return `[${Array.from(value, (v, i) => in_toml(v, `${place}[${i}]`, put_file)).join(", ")}]`;
  if (value === null || typeof value !== "object")
    throw new Error(`${place}: ${value} cannot be in a scene: give a number, a text, true, false, a list or an object`);
  return `{ ${entries_of(value, place, put_file).join(", ")} }`;
}

function entries_of(object, place, put_file) {
  return Object.entries(object).filter(([, value]) => value !== undefined)
    .map(([key, value]) => `${JSON.stringify(key)} = ${in_toml(value, place ? `${place}.${key}` : key, put_file)}`);
}

// VTK's numbers of cell types.
const cell_types = {triangles: [5, 3], tetrahedra: [10, 4], hexahedra: [12, 8], prisms: [13, 6], pyramids: [14, 5]};

// A file in VTK's old format, with these arrays.
function mesh_file(mesh, place) {
  const parts = [];
  const text = (t) => parts.push(new TextEncoder().encode(t));
  const numbers = (values, bytes, set) => {
    const view = new DataView(new ArrayBuffer(values.length * bytes));
    for (let i = 0; i < values.length; ++i) view[set](i * bytes, values[i]);
    parts.push(new Uint8Array(view.buffer), new Uint8Array([10]));
  };
  const cells = [];
  const types = [];
  for (const [name, [type, corners]] of Object.entries(cell_types)) {
    const list = mesh[name] ?? [];
    if (list.length % corners !== 0) throw new Error(`${place}.${name}: its length must be a multiple of ${corners}`);
    for (let i = 0; i < list.length; i += corners) {
      cells.push(corners, ...list.slice(i, i + corners));
      types.push(type);
    }
  }
  text(`# vtk DataFile Version 3.0\nmesh\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS ${mesh.points.length / 3} double\n`);
  numbers(mesh.points, 8, "setFloat64");
  text(`CELLS ${types.length} ${cells.length}\n`);
  numbers(cells, 4, "setUint32");
  text(`CELL_TYPES ${types.length}\n`);
  numbers(types, 4, "setUint32");
  const put_data = (kind, count, data) => {
    if (!data) return;
    text(`${kind} ${count}\n`);
    for (const [name, values] of Object.entries(data)) {
      const components = values.length / count;
      text(components === 3 ? `VECTORS ${name} double\n` : `SCALARS ${name} double ${components}\nLOOKUP_TABLE default\n`);
      numbers(values, 8, "setFloat64");
    }
  };
  put_data("CELL_DATA", types.length, mesh.cellData);
  put_data("POINT_DATA", mesh.points.length / 3, mesh.pointData);
  return parts;
}

// A file of a surface, with all digits.
function surface_file(surface) {
  const rows = (values) => Array.from({length: values.length / 3}, (_, i) => Array.from(values.slice(3 * i, 3 * i + 3)));
  const text = `OFF\n${surface.points.length / 3} ${surface.triangles.length / 3} 0\n` +
    [...rows(surface.points).map((p) => p.join(" ")), ...rows(surface.triangles).map((t) => `3 ${t.join(" ")}`)].join("\n");
  return [new TextEncoder().encode(`${text}\n`)];
}

function joined(parts) {
  const out = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  parts.reduce((at, part) => (out.set(part, at), at + part.length), 0);
  return out;
}

class Simulation {
  #engine;
  #memory;
  #files = 0;

  constructor(scene, {files = {}} = {}) {
    if (!compiled) throw new Error("dartcast is not loaded: call `await load()` first");
    const engine = {
      instantiateWasm: (imports, done) => {
        const instance = new WebAssembly.Instance(compiled, imports);
        this.#memory = Object.values(instance.exports).find((e) => e instanceof WebAssembly.Memory);
        done(instance);
        return instance.exports;
      },
    };
    createEngine(engine);
    this.#engine = engine;
    for (const [name, bytes] of Object.entries(files)) this.#write(name, bytes);
    this.#take("make", scene);
  }

  #alive() {
    if (!this.#engine) throw new Error("the simulation is deleted");
    return this.#engine;
  }

  #write(name, bytes) {
    const {FS} = this.#engine;
    const folders = name.split("/").slice(0, -1);
    folders.forEach((_, i) => {
      const folder = `/${folders.slice(0, i + 1).join("/")}`;
      if (!FS.analyzePath(folder).exists) FS.mkdir(folder);
    });
    FS.writeFile(`/${name}`, new Uint8Array(bytes.buffer ?? bytes, bytes.byteOffset ?? 0, bytes.byteLength));
  }

  // Meshes and files in memory get names. A surface is named by its key.
  #put_file(value, place) {
    const is_surface = value.bytes === undefined && !place.startsWith("environment");
    const name = value.bytes !== undefined ? value.file : `${is_surface ? "surface" : "mesh"}${++this.#files}.${is_surface ? "off" : "vtk"}`;
    if (typeof name !== "string") throw new Error(`${place}: bytes need a name, such as {file: "vessel.vtu", bytes}`);
    this.#write(name, value.bytes ?? joined(is_surface ? surface_file(value) : mesh_file(value, place)));
    return name;
  }

  #take(name, scene) {
    const text = typeof scene === "string" ? scene : `${entries_of(scene, "", (value, place) => this.#put_file(value, place)).join("\n")}\n`;
    const engine = this.#alive();
    const size = engine.lengthBytesUTF8(text) + 1;
    const at = engine._malloc(size);
    engine.stringToUTF8(text, at, size);
    try {
      this.#call(name, at);
    } catch (error) {
      if (typeof scene !== "string") error.message = error.message.replace(/^scene\.toml:\d+: /, "");
      throw error;
    } finally {
      engine._free(at);
    }
  }

  #text(name) {
    return this.#alive().UTF8ToString(this.#engine[`_dartcast_${name}`]());
  }

  #call(name, ...values) {
    const error = this.#alive().UTF8ToString(this.#engine[`_dartcast_${name}`](...values));
    if (error) throw new Error(error);
  }

  #read(name, index = 0) {
    const what = arrays.indexOf(name);
    const at = this.#alive()._dartcast_read(what, index);
    const kind = what < first_of_integers ? Float64Array : Uint32Array;
    return new kind(this.#memory.buffer, at, this.#engine._dartcast_length()).slice();
  }

  step(count = 1) { this.#call("step", count); }
  add(parts) { this.#take("add", parts); }
  edit(event) { this.#take("edit", typeof event === "string" ? event : {event: [{at: 0, ...event}]}); }
  cut(cut) { this.edit({kind: "cut", ...cut}); }
  carve(carve) { this.edit({kind: "carve", ...carve}); }
  tie(tie) { this.edit({kind: "ligature", ...tie}); }
  steer(catheter, {push = 0, turn = 0} = {}) { this.#call("steer", catheter, push, turn); }
  steerSolid(solid, {velocity = [0, 0, 0], turn = [0, 0, 0]} = {}) { this.#call("steer_solid", solid, ...velocity, ...turn); }
  pull({at, by, reach, duration, displacements}) {
    if (displacements === undefined) return this.#call("pull", ...at, ...by, reach, duration);
    const place = this.#alive()._malloc(8 * displacements.length);
    new Float64Array(this.#memory.buffer, place, displacements.length).set(displacements);
    try {
      this.#call("pull_all", place, displacements.length, duration);
    } finally {
      this.#engine._free(place);
    }
  }

  info() { return JSON.parse(this.#text("info")); }
  positions() { return this.#read("positions"); }
  velocities() { return this.#read("velocities"); }
  radii() { return this.#read("radii"); }
  ids() { return this.#read("ids"); }
  vertices() { return this.#read("vertices"); }
  walls(known) {
    const version = this.info().edits;
    const points = this.#read("wall_points");
    if (version === known) return {version, points};
    return {version, points, triangles: this.#read("wall_triangles"), patches: this.#read("wall_patches"), vertices: this.#read("wall_vertices")};
  }
  contacts() {
    const rows = this.#read("contacts");
    const count = rows.length / 9;
    const column = (first, size) => Float64Array.from({length: size * count}, (_, i) => rows[9 * Math.floor(i / size) + first + (i % size)]);
    return {ids: column(0, 1), patches: column(1, 1), times: column(2, 1), points: column(3, 3), normals: column(6, 3)};
  }
  solids() {
    return this.info().solids.map((solid, i) => ({...solid, points: this.#read("solid_points", i), triangles: this.#read("solid_triangles", i)}));
  }
  catheterFrames(catheter) {
    if (!(catheter < this.info().solids.filter((s) => s.kind === "catheter").length)) throw new Error(`there is no catheter ${catheter}`);
    return this.#read("catheter_frames", catheter);
  }

  checkpoint() {
    return {build, memory: new Uint8Array(this.#memory.buffer).slice(0, this.#alive()._dartcast_memory())};
  }
  restore(saved) {
    if (saved?.build !== build) throw new Error("the checkpoint is of another version of the engine");
    const engine = this.#alive();
    if (this.#memory.buffer.byteLength < saved.memory.length) engine._free(engine._malloc(saved.memory.length));  // it grows
    new Uint8Array(this.#memory.buffer).set(saved.memory);
  }
  audit() { return JSON.parse(this.#text("audit")); }
  stateHash() { return this.#text("hash"); }
  delete() { this.#engine = this.#memory = undefined; }
}

// --- In a worker: the same calls as promises.

const methods = Object.getOwnPropertyNames(Simulation.prototype).filter((name) => name !== "constructor");

function listen(port, take) {
  if (port.on) port.on("message", take);
  else port.addEventListener("message", (event) => take(event.data));
}

function buffers_of(value) {
  if (ArrayBuffer.isView(value)) return [value.buffer];
  return value && typeof value === "object" ? Object.values(value).flatMap(buffers_of) : [];
}

/// Answers the messages of a RemoteSimulation.
function serve(port) {
  let simulation;
  listen(port, async ({id, method, values}) => {
    try {
      let result;
      if (method === "make") {
        const [source, scene, options] = values;
        await load(source ?? undefined);
        simulation?.delete();
        simulation = new Simulation(scene, options);
      } else {
        result = simulation[method](...values);
      }
      port.postMessage({id, result}, buffers_of(result));
    } catch (error) {
      port.postMessage({id, error: error.message});
    }
  });
}

class RemoteSimulation {
  #worker;
  #waiting = new Map();
  #last = 0;

  static async make(scene, {wasm, worker, ...options} = {}) {
    const own = new RemoteSimulation();
    own.#worker = worker ?? new Worker(new URL("worker.mjs", base), {type: "module"});
    listen(own.#worker, ({id, result, error}) => {
      const [resolve, reject] = own.#waiting.get(id);
      own.#waiting.delete(id);
      if (error === undefined) resolve(result);
      else reject(new Error(error));
    });
    try {
      await own.#send("make", [wasm, scene, options]);
    } catch (error) {
      own.#worker.terminate?.();
      throw error;
    }
    return own;
  }

  #send(method, values) {
    return new Promise((resolve, reject) => {
      if (!this.#worker) return reject(new Error("the simulation is deleted"));
      this.#waiting.set(++this.#last, [resolve, reject]);
      this.#worker.postMessage({id: this.#last, method, values});
    });
  }

  async delete() {
    this.#worker?.terminate?.();
    this.#worker = undefined;
    for (const [, reject] of this.#waiting.values()) reject(new Error("the simulation is deleted"));
    this.#waiting.clear();
  }

  static {
    for (const name of methods.filter((m) => m !== "delete"))
      this.prototype[name] = function (...values) { return this.#send(name, values); };
  }
}
