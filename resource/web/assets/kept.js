// What this browser keeps of the page, in IndexedDB, which works on pages without encryption, too: marks on their way,
// marks that can be taken back, and what was shown last.

const STORES = ["waiting", "done", "shown"];

const opened = new Promise((done, failed) => {
  const asked = indexedDB.open("roah_rsbb", 1);
  asked.onupgradeneeded = () => STORES.forEach((store) => asked.result.createObjectStore(store));
  asked.onsuccess = () => done(asked.result);
  asked.onerror = asked.onblocked = () => failed(asked.error);
});
opened.catch(() => {});  // whoever asks learns it

// All functions raise an error if the browser refuses its storage, or if that is full.
async function asked(store, mode, act) {
  const base = await opened;
  return new Promise((done, failed) => {
    // On the disk when it is done: a phone may be without power in the next moment.
    const transaction = base.transaction(store, mode, {durability: "strict"});
    const answer = act(transaction.objectStore(store));
    transaction.oncomplete = () => done(answer.result);
    transaction.onabort = transaction.onerror = () => failed(transaction.error);
  });
}

export const keep = (store, key, value) => asked(store, "readwrite", (kept) => kept.put(value, key));
export const drop = (store, key) => asked(store, "readwrite", (kept) => kept.delete(key));
export const kept = (store) => asked(store, "readonly", (all) => all.getAll());
