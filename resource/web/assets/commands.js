// Commands of a paired device, and marks until each was answered (docs/web.md, "Referees"). STOP is in stop.js.

import {ask} from "/assets/device.js";

const MARK_AGAIN_MS = 2000;
// A mark without an answer is shown as not confirmed.
const LATE_MS = 1000;
// Browsers have six connections: STOP must find one that is free.
const MARKS_AT_ONCE = 2;
// Each mark has a key of its own: several tabs of a browser keep theirs beside each other.
const KEPT = "roah_rsbb_mark ", DONE = "roah_rsbb_done ";
// Marks that can be taken back after the page was loaded again.
const MOST_DONE = 50;
// Answers after which a mark is sent again: whether it counted is not known, or the box was not ready.
const AGAIN = [0, 401, 429, 503, 504];
// The box has the mark, but it is not on all disks yet: the mark is sent again until it is.
const NOT_ON_DISKS = 202;

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

// Marks that were not answered yet. They survive a reload of the page, and are sent again with the same identity.
export class Marks {
  constructor(onChange) {
    this.onChange = onChange;
    this.waiting = kept(KEPT).map((mark) => ({...mark, isLate: true}));  // the oldest first
    this.done = kept(DONE);  // the newest last: for undo
    this.done.splice(0, Math.max(0, this.done.length - MOST_DONE)).forEach(drop);
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
      this.waiting.forEach((mark) => { mark.isDue = true; });
      this.sendNext();
    }
  }

  // Those of an item one after the other: they must arrive as they were entered. Those that the box has wait for
  // nobody, and nobody waits for them.
  sendNext() {
    const items = new Set();
    for (const mark of this.waiting.filter((one) => !one.isAtBox)) {
      const item = [mark.identity, mark.group, mark.desc].join("\n");
      if (!items.has(item) && !this.isSending.has(mark.id) && this.isSending.size < MARKS_AT_ONCE) {
        this.send(mark);
      }
      items.add(item);
    }
    for (const mark of this.waiting.filter((one) => one.isAtBox && one.isDue)) {
      if (!this.isSending.has(mark.id) && this.isSending.size < MARKS_AT_ONCE) {
        this.send(mark);
      }
    }
  }

  async send(mark) {
    this.isSending.add(mark.id);
    const {shown, isLate, isUndo, isAtBox, isDue, made, command = "mark", ...body} = mark;
    mark.isDue = false;
    const late = setTimeout(() => this.isNotConfirmed(mark), LATE_MS);
    const answer = await send(command, body);
    clearTimeout(late);
    this.isSending.delete(mark.id);
    if (AGAIN.includes(answer.status)) {
      this.isNotConfirmed(mark);
      return;
    }
    if (answer.status === NOT_ON_DISKS) {
      mark.isAtBox = true;
      this.isNotConfirmed(mark);
      this.sendNext();
      return;
    }
    this.waiting = this.waiting.filter((one) => one.id !== mark.id);
    tryTo(() => localStorage.removeItem(KEPT + mark.id));
    if (answer.status !== 200) {
      this.refused.push({...mark, reasons: answer.body.reasons});
    } else if (answer.body.number && !isUndo && command === "mark") {
      const last = {...body, made, number: answer.body.number, shown: `${mark.desc}: ${shown}`};
      this.done.push(last);
      tryTo(() => localStorage.setItem(DONE + last.id, JSON.stringify(last)));
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
    drop(mark);
    this.done = this.done.filter((one) => one !== mark);
    this.onChange();
  }

  // What was added is taken off again: others may have counted since.
  takeOff(added) {
    drop(added);
    this.done = this.done.filter((one) => one !== added);
    const {number, shown, ...mark} = added;
    const off = -Number(mark.added);
    this.add({...mark, added: String(off), note: "", isUndo: true, shown: off < 0 ? `−${-off}` : `+${off}`});
  }
}

function kept(kind) {
  const keys = tryTo(() => Object.keys(localStorage)) || [];
  return keys.filter((key) => key.startsWith(kind)).map((key) => JSON.parse(localStorage.getItem(key)))
    .sort((one, other) => one.made - other.made);
}

const drop = (done) => tryTo(() => localStorage.removeItem(DONE + done.id));

// crypto.randomUUID exists on encrypted pages only.
function newId() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  bytes[6] = (bytes[6] & 0x0f) | 0x40;
  bytes[8] = (bytes[8] & 0x3f) | 0x80;
  const digits = [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  return [[0, 8], [8, 12], [12, 16], [16, 20], [20]].map((part) => digits.slice(...part)).join("-");
}
