// The one time of the page: what plays, and whom it tells.

class Clock {
  constructor(first, last) {
    this.first = first;
    this.last = last;
    this.time = first;
    this.playing = false;
    this.speed = 1; // seconds of the motion in a second
    this.listeners = [];
    this.loop = (stamp) => this.advance(stamp);
  }

  listen(listener) {
    this.listeners.push(listener);
  }

  set(time) {
    this.time = Math.min(this.last, Math.max(this.first, time));
    for (const listener of this.listeners) listener(this.time);
  }

  play(on = !this.playing) {
    if (on === this.playing) return;
    this.playing = on;
    this.stamp = null;
    if (on && this.time >= this.last) this.time = this.first;
    if (on) requestAnimationFrame(this.loop);
    this.set(this.time);
  }

  advance(stamp) {
    if (!this.playing) return;
    const passed = this.stamp === null ? 0 : Math.min(0.1, (stamp - this.stamp) / 1000);
    this.stamp = stamp;
    const next = this.time + passed * this.speed;
    if (next >= this.last) this.play(false);
    this.set(next);
    if (this.playing) requestAnimationFrame(this.loop);
  }
}

const clock = new Clock(FIRST, LAST);
