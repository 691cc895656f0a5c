// What a paired device asks of the gateway (docs/security.md, "Paired devices").

const ANSWER_MS = 6000;

// Ask the gateway. Returns {status, body}; status 0: there was no answer.
export async function ask(method, path, body) {
  const stop = new AbortController();
  const timer = setTimeout(() => stop.abort(), ANSWER_MS);
  try {
    const answer = await fetch(`/api/v1/${path}`, {
      method, credentials: "same-origin", cache: "no-store", signal: stop.signal,
      ...(body ? {headers: {"Content-Type": "application/json"}, body: JSON.stringify(body)} : {}),
    });
    const text = await answer.text();
    const isJson = (answer.headers.get("Content-Type") || "").includes("json");
    return {status: answer.status, body: isJson ? JSON.parse(text) : {reasons: [text.trim()]}};
  } catch (error) {
    return {status: 0, body: {reasons: []}};
  } finally {
    clearTimeout(timer);
  }
}

export function roleText(session, texts) {
  const role = texts[`role_${session.role}`];
  return (session.zone ? texts.role_in_zone : texts.role_everywhere)
    .replace("{role}", () => role).replace("{zone}", () => session.zone);
}

// The page to which pairing leads.
export const ownPage = (session) => session.role === "organiser" ? "/box" : "/referee";

export function reasonsText(answer, texts) {
  return answer.status === 0 ? texts.no_answer : answer.body.reasons.join("; ");
}

// What this device probably is, as its user may see it.
export function deviceName() {
  const agent = navigator.userAgent;
  const kinds = [["iPhone", "iPhone"], ["iPad", "iPad"], ["Android", "Android"], ["Windows", "Windows"],
    ["Mac OS", "Mac"], ["Linux", "Linux"]];
  const found = kinds.find(([mark]) => agent.includes(mark));
  return found ? found[1] : "browser";
}
