// Commands of a paired device: STOP until it is confirmed, and marks until each was answered (docs/web.md, "Referees").

import {ask} from "/assets/device.js";

const STOP_AGAIN_MS = 500;
const MARK_AGAIN_MS = 2000;
// A mark without an answer is shown as not confirmed.
const LATE_MS = 1000;
// Browsers have six connections: STOP must find one that is free.
const MARKS_AT_ONCE = 2;
// Each mark has a key of its own: several tabs of a browser keep theirs beside each other.
const KEPT = "roah_rsbb_mark ";
const STOPPING = "roah_rsbb_stop";
// Answers after which a mark is sent again: whether it counted is not known, or the box was not ready.
const AGAIN = [0, 401, 429, 503, 504];

const wait = (ms) => new Promise((done) => setTimeout(done, ms));

// The answer is in the language of the page.
export const send = (name, body) => ask("POST", `commands/${name}`, {language: document.documentElement.lang, ...body});

// Runs a function that may use a storage which the browser refuses or which is full: the page works without it.
function tryTo(act) {
  try {
    return act();
  } catch (error) {
    return null;
  }
}

// Phones make sounds only after a touch, and iPhones only if the sound was allowed while they were touched.
let audio = null;
window.addEventListener("click", () => {
  audio = audio || new AudioContext();
  if (audio.state !== "running") {
    audio.resume();
  }
});

// A short tone, and a vibration where there is one.
export function signal(frequency, pattern) {
  if (navigator.vibrate) {
    navigator.vibrate(pattern);
  }
  try {
    audio = audio || new AudioContext();
    pattern.forEach((ms, number) => {
      if (number % 2 === 0) {
        const begin = audio.currentTime + pattern.slice(0, number).reduce((sum, each) => sum + each, 0) / 1000;
        const tone = audio.createOscillator(), volume = audio.createGain();
        tone.frequency.value = frequency;
        volume.gain.value = 0.3;
        tone.connect(volume).connect(audio.destination);
        tone.start(begin);
        tone.stop(begin + ms / 1000);
      }
    });
  } catch (error) {
    // Without sound the page still shows it.
  }
}

// One STOP of one run, repeated until the box confirms or refuses it. It never stops another run.
export class Stop {
  constructor(zone, identity, onChange) {
    this.zone = zone;
    this.identity = identity;
    this.tries = 0;
    this.state = "sending";  // then confirmed or refused: only the answer ends it, never what the page shows
    this.reasons = [];
    this.onChange = onChange;
  }

  // The one that this tab did not finish, as it was reloaded; null: there is none.
  static unfinished(onChange) {
    const kept = tryTo(() => JSON.parse(sessionStorage.getItem(STOPPING)));
    return kept && new Stop(kept.zone, kept.identity, onChange);
  }

  async repeat() {
    const kept = JSON.stringify({zone: this.zone, identity: this.identity});
    while (this.state === "sending") {
      this.tries += 1;
      const asked = send("stop", {zone: this.zone, identity: this.identity});
      tryTo(() => sessionStorage.setItem(STOPPING, kept));
      this.show();
      // The next try does not wait for an answer that may never come.
      const answer = await Promise.race([asked, wait(STOP_AGAIN_MS * 4).then(() => ({status: 0, body: {}}))]);
      if (answer.status === 200) {
        this.state = "confirmed";
      } else if ([400, 401, 403, 409].includes(answer.status)) {
        this.state = "refused";
        this.isPaired = answer.status !== 401;
        this.reasons = answer.body.reasons;
      } else {
        signal(880, [200, 100, 200]);
        await wait(STOP_AGAIN_MS);
      }
    }
    tryTo(() => sessionStorage.getItem(STOPPING) === kept && sessionStorage.removeItem(STOPPING));
    this.show();
  }

  // A page that cannot be drawn does not end STOP.
  show() {
    try {
      this.onChange();
    } catch (error) {
      console.error(error);
    }
  }
}

// Marks that were not answered yet. They survive a reload of the page, and are sent again with the same identity.
export class Marks {
  constructor(onChange) {
    this.onChange = onChange;
    this.waiting = keptMarks();  // the oldest first
    this.done = [];  // the newest last: for undo
    this.refused = [];  // until the referee has read it
    this.isSending = new Set();
    this.isLinked = () => true;
    setInterval(() => this.again(), MARK_AGAIN_MS);
  }

  add(mark) {
    const made = {...mark, id: newId(), made: Date.now(), isLate: false};
    this.waiting.push(made);
    tryTo(() => localStorage.setItem(KEPT + made.id, JSON.stringify(made)));
    this.sendNext();
    this.onChange();
  }

  again() {
    if (this.isLinked()) {
      this.sendNext();
    }
  }

  // Those of an item one after the other: they must arrive as they were entered.
  sendNext() {
    const items = new Set();
    for (const mark of this.waiting) {
      const item = [mark.identity, mark.group, mark.desc].join("\n");
      if (!items.has(item) && !this.isSending.has(mark.id) && this.isSending.size < MARKS_AT_ONCE) {
        this.send(mark);
      }
      items.add(item);
    }
  }

  async send(mark) {
    this.isSending.add(mark.id);
    const {shown, isLate, isUndo, made, command = "mark", ...body} = mark;
    const late = setTimeout(() => this.isNotConfirmed(mark), LATE_MS);
    const answer = await send(command, body);
    clearTimeout(late);
    this.isSending.delete(mark.id);
    if (AGAIN.includes(answer.status)) {
      this.isNotConfirmed(mark);
      return;
    }
    this.waiting = this.waiting.filter((one) => one.id !== mark.id);
    tryTo(() => localStorage.removeItem(KEPT + mark.id));
    if (answer.status !== 200) {
      this.refused.push({...mark, reasons: answer.body.reasons});
    } else if (answer.body.number && !isUndo && command === "mark") {
      this.done.push({...body, number: answer.body.number, shown: `${mark.desc}: ${shown}`});
    }
    this.sendNext();
    this.onChange();
  }

  isNotConfirmed(mark) {
    mark.isLate = true;
    this.onChange();
  }

  // The referee has read that a mark was refused.
  close(refused) {
    this.refused = this.refused.filter((one) => one !== refused);
    this.onChange();
  }

  // The last mark of this device in a run.
  last(identity) {
    return this.done.filter((mark) => mark.identity === identity).pop();
  }

  // A mark was taken back.
  forget(mark) {
    this.done = this.done.filter((one) => one !== mark);
    this.onChange();
  }

  // What was added is taken off again: others may have counted since.
  takeOff(added) {
    this.done = this.done.filter((one) => one !== added);
    const {number, shown, ...mark} = added;
    this.add({...mark, value: -mark.value, note: "", isUndo: true, shown: mark.value > 0 ? `−${mark.value}` : `+${-mark.value}`});
  }
}

function keptMarks() {
  const keys = tryTo(() => Object.keys(localStorage)) || [];
  return keys.filter((key) => key.startsWith(KEPT)).map((key) => ({...JSON.parse(localStorage.getItem(key)), isLate: true}))
    .sort((one, other) => one.made - other.made);
}

// crypto.randomUUID exists on encrypted pages only.
function newId() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  bytes[6] = (bytes[6] & 0x0f) | 0x40;
  bytes[8] = (bytes[8] & 0x3f) | 0x80;
  const digits = [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  return [[0, 8], [8, 12], [12, 16], [16, 20], [20]].map((part) => digits.slice(...part)).join("-");
}
