// The engine of dartcast in JavaScript. Units are SI; points and vectors are three numbers each, one after another. Arrays
// are copies. Errors have the words of the C++ library.

/** A table with the keys of scene files (docs/scene.md), or a part of it. */
export type Table = {[key: string]: Value};
export type Value = number | bigint | string | boolean | Value[] | ArrayLike<number> | Mesh | File | Table | undefined;

/** A mesh in place of a file's name. Corners of cells are numbers of points, in VTK's order. */
export interface Mesh {
  points: Float64Array;
  /** In the plane the cells; in space faces with the patch of their cell data. */
  triangles?: ArrayLike<number>;
  tetrahedra?: ArrayLike<number>;
  hexahedra?: ArrayLike<number>;
  prisms?: ArrayLike<number>;
  pyramids?: ArrayLike<number>;
  /** Arrays of values, one or three numbers for each cell (in the order of the lists above) or point. */
  cellData?: {[name: string]: ArrayLike<number>};
  pointData?: {[name: string]: ArrayLike<number>};
}
/** A file in memory in place of its name. Its ending says its format: .msh .vtu .vtk .mesh and others. */
export interface File {
  file: string;
  bytes: Uint8Array;
}

export interface Options {
  /** Files that the scene names. */
  files?: {[name: string]: Uint8Array};
}

export interface Info {
  steps: number;
  time: number;
  dt: number;
  dimension: 2 | 3;
  particles: number;
  /** How many edits there have been: the version of the walls. */
  edits: number;
  deforms: boolean;
  /** Names by number; the first, of walls without a patch, is empty. */
  patches: string[];
  solids: {kind: "body" | "solid" | "catheter"; name: string}[];
  totals: {start: number; injected: number; absorbed: number; escaped: number; contacts_by_patch: number[]};
  warnings: string[];
}

/** In the plane a wall is a side: the third corner repeats the second. */
export interface Walls {
  version: number;
  points: Float64Array;
  /** Places in `points`. This and what follows is there if the version is not the known one. */
  triangles?: Uint32Array;
  patches?: Uint32Array;
  /** Places in vertices(), of the points. */
  vertices?: Uint32Array;
}

/** Contacts of particles in the last step. */
export interface Contacts {
  ids: Float64Array;
  patches: Float64Array;
  /** Shares of the step, in [0, 1]. */
  times: Float64Array;
  points: Float64Array;
  /** Unit vectors into the free side. */
  normals: Float64Array;
}

export interface Solid {
  kind: "body" | "solid" | "catheter";
  name: string;
  /** Of a catheter: from the tip to the entry. */
  points: Float64Array;
  /** Empty for catheters, lines, and bodies of particles alone. */
  triangles: Uint32Array;
}

/** `by` in m at the place `at`, which fades out at the distance `reach`; or a displacement of each of vertices(). */
export type Pull =
  | {at: ArrayLike<number>; by: ArrayLike<number>; reach: number; duration: number}
  | {displacements: Float64Array; duration: number};

/** The whole state of an engine: plain data, to be kept or sent. */
export interface Checkpoint {
  build: string;
  memory: Uint8Array;
}

export interface Audit {
  checked: number;
  failed: number;
  first: string;
}

/** Compiles the engine once: from bytes, a compiled module, or dartcast.wasm beside this file. Throws if WebAssembly lacks what it needs. */
export function load(source?: BufferSource | WebAssembly.Module | Promise<BufferSource>): Promise<void>;

export class Simulation {
  /** `scene`: an object, or the text of a scene file. Throws if load() has not ended, or as the command refuses a scene. */
  constructor(scene: Table | string, options?: Options);
  step(count?: number): void;
  /** Adds the `particles`, `body`, `catheter` and `solid` tables of these parts of a scene. */
  add(parts: Table | string): void;
  /** Makes an [[event]] now, at whatever time; or all of a text. Throws, nothing changed, if it is refused. */
  edit(event: Table | string): void;
  /** edit() of the kinds cut, carve and ligature. */
  cut(cut: Table): void;
  carve(carve: Table): void;
  tie(tie: Table): void;
  /** Moves a catheter by hand: m and rad in each step from the next on, until the next call. */
  steer(catheter: number, input?: {push?: number; turn?: number}): void;
  /** Likewise a solid tool (its place among the tools): m / s and rad / s. */
  steerSolid(solid: number, input?: {velocity?: ArrayLike<number>; turn?: ArrayLike<number>}): void;
  /** Pulls vertices along over some seconds; they stay there. */
  pull(pull: Pull): void;
  info(): Info;
  positions(): Float64Array;
  velocities(): Float64Array;
  radii(): Float64Array;
  ids(): Float64Array;
  /** All points of the environment. */
  vertices(): Float64Array;
  /** `known`: the version that the caller has. */
  walls(known?: number): Walls;
  contacts(): Contacts;
  solids(): Solid[];
  /** Tangent, normal and binormal at each point of a catheter. */
  catheterFrames(catheter: number): Float64Array;
  checkpoint(): Checkpoint;
  /** Goes back or on to a checkpoint of the same scene, edits included: every later step is the same to the last bit. */
  restore(saved: Checkpoint): void;
  audit(): Audit;
  stateHash(): string;
  /** Gives the memory back. The simulation cannot be used after that. */
  delete(): void;
}

type Remote<T> = {[K in keyof T]: T[K] extends (...values: infer V) => infer R ? (...values: V) => Promise<R> : never};

/** A simulation in a worker: the same calls as promises, in order. */
export interface RemoteSimulation extends Remote<Simulation> {}
export class RemoteSimulation {
  /** `wasm`: as the source of load(), but a module or bytes. `worker`: one that calls serve(); else worker.mjs beside this file. */
  static make(scene: Table | string, options?: Options & {wasm?: BufferSource | WebAssembly.Module; worker?: Worker}): Promise<RemoteSimulation>;
}

/** In a worker: answers a RemoteSimulation. `port`: `self`, or under node the worker's parentPort. */
export function serve(port: unknown): void;
