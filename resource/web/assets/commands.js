// Commands of a paired device, and the queue of what it enters (docs/web.md, "Without a link"). STOP is in stop.js.

import {ask} from "/assets/device.js";
import {drop, keep, kept} from "/assets/kept.js";

const AGAIN_MS = 2000;
// A mark without an answer is shown as not confirmed.
const LATE_MS = 1000;
// Marks that can be taken back after the page was loaded again.
const MOST_DONE = 50;
// Answers after which a mark is sent again: whether it counted is not known, or the box was not ready.
const AGAIN = [0, 401, 429, 503, 504];
// The box has the mark, but it is not on all disks yet: the mark is sent again until it is.
const NOT_ON_DISKS = 202;
const MARK = "mark", TAKE_BACK = "take_back";

// The answer is in the language of the page.
export const send = (name, body) => ask("POST", `commands/${name}`, {language: document.documentElement.lang, ...body});

// The queue: marks, notes and undo, and nothing else. Each is kept by the browser until the box has answered it, also when
// the page is closed or the phone is restarted, and arrives once: the box knows its `id`. They are sent one after the
// other, in the order in which they were entered, with the phone's clock then (`made`) and at sending (`now`), in ms: so it
// does not matter if that clock is wrong. For who draws them:
//   add(mark)       {zone, identity, shown, ...} and the fields of `command`, which is "mark" without one. `shown`: what is
//                   entered, in words. A note that got its text later names the note: {command: "note", of: its id, text}
//   waiting         not answered yet, the oldest first: what was added, with `id`, `made`, `isLate` (show it as not
//                   confirmed) and `isAtBox` (the box has it, but not on all disks)
//   refused         with `reasons`, until close(mark)
//   last(identity)  the last mark in a run that can be taken back, or undefined; its `shown` names the item, too
//   undo(last, shown)
//   count()         how many the box has taken since the page was opened
//   again()         sends now: there is a link again. `isLinked` says whether there is one
//   isKept          false: the browser keeps nothing. Its user must not close the page while something waits
//   ready           is done when what was kept before is read
export class Marks {
  constructor(onChange) {
    this.onChange = onChange;
    this.waiting = [];
    this.done = [];  // the newest last: for undo
    this.refused = [];
    this.sent = 0;
    this.isKept = true;
    this.isLinked = () => true;
    this.sending = null;
    this.order = 0;
    this.ready = this.read();
    setInterval(() => this.again(), AGAIN_MS);
  }

  // Those that were added meanwhile are later ones.
  async read() {
    const [waiting, done] = await Promise.all(["waiting", "done"].map((store) => this.tryTo(() => kept(store))));
    const inOrder = (list) => (list || []).sort((one, other) => one.order - other.order);
    this.waiting = [...inOrder(waiting).map((mark) => ({...mark, isLate: true, wasSent: true})), ...this.waiting];
    this.done = [...inOrder(done), ...this.done];
    this.done.splice(0, Math.max(0, this.done.length - MOST_DONE)).forEach((mark) => this.forget(mark));
    this.isRead = true;
    this.sendNext();
    this.onChange();
  }

  // The page works without the browser's storage.
  async tryTo(act) {
    try {
      return await act();
    } catch (error) {
      console.error(error);
      this.isKept = false;
      this.onChange();
      return null;
    }
  }

  add(mark) {
    const made = Date.now();
    // The clock of a phone may be put back: what was entered later is sent later.
    this.order = Math.max(made, this.order + 1, ...this.waiting.map((one) => one.order + 1));
    const added = {command: MARK, ...mark, id: newId(), made, order: this.order, isLate: !this.isLinked()};
    this.waiting.push(added);
    this.tryTo(() => keep("waiting", added.id, added));
    this.sendNext();
    this.onChange();
    return added;
  }

  again() {
    this.waiting.forEach((mark) => (mark.isDue = true));
    this.sendNext();
  }

  // The oldest first. Those that the box has wait for nobody, and nobody waits for them.
  sendNext() {
    const next = this.waiting.find((mark) => !mark.isAtBox) || this.waiting.find((mark) => mark.isDue);
    if (next && !this.sending && this.isRead && this.isLinked()) {
      this.send(next);
    } else if (next && !this.isLinked()) {
      this.waiting.forEach((mark) => (mark.isLate = true));
    }
  }

  async send(mark) {
    const {shown, order, isLate, isUndo, isUndone, isAtBox, isDue, wasSent, of, desc, group, command, ...body} = mark;
    Object.assign(mark, {isDue: false, wasSent: true});
    this.sending = mark;
    const late = setTimeout(() => this.isNotConfirmed(mark), LATE_MS);
    const answer = await send(command, {...body, ...(of ? {id: of} : {}), ...(desc === undefined ? {} : {group, desc}),
      now: Date.now()});
    clearTimeout(late);
    this.sending = null;
    if (AGAIN.includes(answer.status)) {
      this.isNotConfirmed(mark);  // `again` sends it, and it stays the first
      return;
    }
    if (answer.status === NOT_ON_DISKS) {
      mark.isAtBox = true;
      this.isNotConfirmed(mark);
      this.sendNext();
      return;
    }
    this.remove(mark);
    if (answer.status !== 200) {
      this.refused.push({...mark, reasons: answer.body.reasons});
      window.strip.signal(330, [80, 80, 80]);
    } else {
      this.sent += 1;
      answer.body.number && this.canBeUndone(mark) && this.remember({...mark, number: answer.body.number});
    }
    this.sendNext();
    this.onChange();
  }

  isNotConfirmed(mark) {
    mark.isLate = true;
    this.onChange();
  }

  remove(mark) {
    this.waiting = this.waiting.filter((one) => one !== mark);
    this.tryTo(() => drop("waiting", mark.id));
  }

  canBeUndone({command, isUndo, isUndone}) {
    return command === MARK && !isUndo && !isUndone;
  }

  remember(mark) {
    this.done.push(mark);
    this.tryTo(() => keep("done", mark.id, mark));
  }

  forget(mark) {
    this.done = this.done.filter((one) => one.id !== mark.id);
    this.tryTo(() => drop("done", mark.id));
  }

  count() {
    return this.sent;
  }

  // The referee has read that a mark was refused.
  close(refused) {
    this.refused = this.refused.filter((one) => one !== refused);
    this.onChange();
  }

  // One that waits longer than usual counts, too.
  last(identity) {
    const late = this.waiting.filter((mark) => mark.isLate && this.canBeUndone(mark));
    const last = [...this.done, ...late].filter((mark) => mark.identity === identity).pop();
    return last && {...last, shown: nameOf(last)};
  }

  // What was added is taken off again: others may have counted since. A mark that was never sent only leaves the queue.
  undo(last, shown) {
    const waiting = this.waiting.find((mark) => mark.id === last.id);
    this.forget(last);
    if (waiting && !waiting.wasSent) {
      this.remove(waiting);
      this.onChange();
      return;
    }
    if (waiting) {
      waiting.isUndone = true;
      this.tryTo(() => keep("waiting", waiting.id, waiting));
    }
    const {zone, identity, group, desc} = last, off = -Number(last.added);
    this.add({zone, identity, isUndo: true, ...(last.added ? {group, desc, added: String(off), shown: off < 0 ? `−${-off}` : `+${off}`}
      : {command: TAKE_BACK, of: last.id, shown})});
  }
}

// What was entered, with its item.
export const nameOf = ({desc, shown}) => desc ? `${desc}: ${shown}` : shown;

// crypto.randomUUID exists on encrypted pages only.
function newId() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  bytes[6] = (bytes[6] & 0x0f) | 0x40;
  bytes[8] = (bytes[8] & 0x3f) | 0x80;
  const digits = [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  return [[0, 8], [8, 12], [12, 16], [16, 20], [20]].map((part) => digits.slice(...part)).join("-");
}
