// Plays a tour: the eye goes along the path that the program has computed, and what is said is shown.
const byId = id => document.getElementById(id);
const clock = ms => `${Math.floor(ms / 60000)}:${String(Math.floor(ms / 1000) % 60).padStart(2, "0")}`;

export class Player {
  // said(n): what is said at a stop; "": nothing.
  constructor(eye, said) {
    Object.assign(this, { eye, said, flight: null, last: 0, ms: 0 }); // last: the time of the last frame; 0: it rests
    byId("play").addEventListener("click", () => this.play());
    byId("when").addEventListener("input", () => { this.pause(); this.ms = Number(byId("when").value); if (this.flight?.poses && eye.camera) this.pose(); });
  }

  // Goes back to the start of another tour, whose path is not known yet.
  begin() {
    this.pause();
    this.flight = null;
    this.ms = 0;
  }

  // flight: as POST /api/tours/ID/flight answers; without poses there is nothing to play.
  take(flight) {
    this.flight = flight;
    if (!flight.poses) this.pause();
    this.ms = Math.min(this.ms, flight.duration_ms || 0);
    byId("play").disabled = byId("when").disabled = !flight.poses;
    byId("when").max = flight.duration_ms || 0;
    this.showTime();
  }

  showTime() {
    byId("when").value = this.ms;
    byId("time").textContent = `${clock(this.ms)} / ${clock(this.flight?.duration_ms || 0)}`;
    byId("when").setAttribute("aria-valuetext", clock(this.ms));
  }

  // Puts the eye where the tour is; poses between two samples are in between.
  pose() {
    const { flight, eye } = this;
    const at = Math.min(this.ms, flight.duration_ms) / flight.step_ms, n = Math.min(Math.floor(at), flight.at.length - 2), share = Math.min(1, at - n);
    const numbers = Array.from({ length: 6 }, (_, i) => flight.poses[6 * n + i] * (1 - share) + flight.poses[6 * n + 6 + i] * share);
    const target = numbers.slice(3), position = numbers.slice(0, 3);
    // The target is a metre away; the eye turns about something farther off when the curator takes over.
    eye.lookFrom(position, position.map((p, i) => p + (target[i] - p) * Math.max(1, eye.camera.size / 8)));
    const said = this.said(flight.at[n]);
    byId("said").textContent = said;
    byId("said").hidden = !said;
    this.showTime();
  }

  pause() {
    if (!this.last) return;
    this.last = 0;
    this.eye.flies = false;
    byId("play").textContent = "Play";
    byId("said").hidden = true;
  }

  step(now) {
    if (!this.last) return;
    this.ms += Math.max(0, Math.min(now - this.last, 250)); // a frame may have begun before it was clicked
    this.last = now;
    this.pose();
    if (this.ms >= this.flight.duration_ms) { this.pause(); this.ms = 0; } else requestAnimationFrame(time => this.step(time));
  }

  play() {
    if (this.last) { this.pause(); return; }
    if (!this.flight?.poses || !this.eye.camera) return;
    if (this.ms >= this.flight.duration_ms) this.ms = 0;
    this.last = performance.now();
    this.eye.flies = true;
    byId("play").textContent = "Pause";
    requestAnimationFrame(time => this.step(time));
  }
}
