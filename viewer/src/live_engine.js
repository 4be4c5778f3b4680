// The page's side of the engine: it asks the worker, which answers in the order of the questions.
export class Engine {
  constructor(program, onProgress) {
    this.waiting = new Map();
    this.asked = 0;
    this.worker = new Worker(URL.createObjectURL(new Blob([program], { type: 'text/javascript' })));
    this.worker.onmessage = ({ data: { id, value, error, progress } }) => {
      if (progress) return onProgress(progress);
      const { resolve, reject } = this.waiting.get(id);
      this.waiting.delete(id);
      return error === undefined ? resolve(value) : reject(new Error(error));
    };
    this.worker.onerror = (e) => this.fail(e.message);
  }

  /** What cannot be answered any more is refused. */
  fail(message) {
    for (const { reject } of this.waiting.values()) reject(new Error(message || 'the engine has stopped'));
    this.waiting.clear();
  }

  stop() {
    this.worker.terminate();
  }

  ask(what, argument) {
    const id = this.asked++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, what, argument });
    });
  }
}
