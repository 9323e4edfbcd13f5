// Values for one reader, in order, until the queue ends or fails.
export class Queue<T> implements AsyncIterableIterator<T> {
  private readonly values: T[] = [];
  private waiting: { resolve: (result: IteratorResult<T>) => void; reject: (error: Error) => void } | undefined;
  private over: { error?: Error } | undefined;

  // `onReturn` is called when the reader leaves its loop before the end.
  constructor(private readonly onReturn: () => void = () => {}) {}

  push(value: T): void {
    if (this.over) return;
    if (this.waiting) {
      this.waiting.resolve({ done: false, value });
      this.waiting = undefined;
    } else {
      this.values.push(value);
    }
  }

  finish(error?: Error): void {
    if (this.over) return;
    this.over = error ? { error } : {};
    if (!this.waiting) return;
    if (error) this.waiting.reject(error);
    else this.waiting.resolve({ done: true, value: undefined });
    this.waiting = undefined;
  }

  next(): Promise<IteratorResult<T>> {
    const value = this.values.shift();
    if (value !== undefined) return Promise.resolve({ done: false, value });
    if (this.over?.error) return Promise.reject(this.over.error);
    if (this.over) return Promise.resolve({ done: true, value: undefined });
    return new Promise((resolve, reject) => (this.waiting = { resolve, reject }));
  }

  return(): Promise<IteratorResult<T>> {
    this.onReturn();
    this.finish();
    return Promise.resolve({ done: true, value: undefined });
  }

  [Symbol.asyncIterator](): this {
    return this;
  }
}
