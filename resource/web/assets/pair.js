// Pairs this device. The link of the QR code is in the address after #, so it is in no log. It begins with the code.

import {Icon, Trouble, address, html, parameters, show, useEffect, useState} from "/assets/parts.js";
import {Missing} from "/assets/phone.js";
import {ask, deviceName, ownPage, reasonsText, roleText} from "/assets/device.js";

const NAME = "roah_rsbb_name";
const linkOf = () => location.hash.slice(1);
const PART = parameters.get("part");

// The page to which pairing leads. A referee's window asks for a part of the page of the whole box.
const leadsTo = (session) => PART && session.role === "organiser"
  ? address("/box", {part: PART, zone: parameters.get("zone") || ""}) : address(ownPage(session));

function Field({name, text, value, ...rest}) {
  const [typed, setTyped] = useState(value);
  return html`
    <label for=${name}>${text}</label>
    <input id=${name} name=${name} value=${typed} onInput=${(event) => setTyped(event.target.value)} autocomplete="off" spellcheck=${false} required maxlength="40" ...${rest} />`;
}

function Pair({live, words}) {
  const texts = live.data["page.device_words"];
  const [session, setSession] = useState(null);
  const [trouble, setTrouble] = useState("");
  const [isBusy, setBusy] = useState(false);
  const [link, setLink] = useState(linkOf);
  const linked = link.slice(0, 9);
  useEffect(() => {  // another link in the same tab loads no page
    const follow = () => setLink(linkOf());
    addEventListener("hashchange", follow);
    return () => removeEventListener("hashchange", follow);
  }, []);
  useEffect(() => {
    ask("GET", "session").then((answer) => answer.status === 200 && (PART && answer.body.role === "organiser"
      ? location.replace(leadsTo(answer.body)) : setSession(answer.body)));
  }, []);
  document.title = texts.pair_title;

  async function pair(event) {
    event.preventDefault();
    const typed = new FormData(event.target);
    setBusy(true);
    const answer = await ask("POST", "pair", {
      code: typed.get("code") === linked ? link : typed.get("code"), person: typed.get("person"), device: typed.get("device"),
      language: parameters.get("language") || "",
    });
    setBusy(false);
    if (answer.status !== 200) {
      setTrouble(reasonsText(answer, texts));
      return;
    }
    localStorage.setItem(NAME, typed.get("person"));
    setTrouble("");
    setSession(answer.body);
    location.replace(leadsTo(answer.body));  // Back must not lead here, and nobody finds the link in the history
  }

  async function end() {
    const answer = await ask("DELETE", "session");
    if (answer.status === 204 || answer.status === 401) {
      setSession(null);
      window.strip && window.strip.pair(false);
    } else {
      setTrouble(reasonsText(answer, texts));
    }
  }

  const isOpen = location.protocol !== "https:" && !["localhost", "127.0.0.1"].includes(location.hostname);
  return html`
    <${Trouble} text=${trouble} />
    <h1>${texts.pair_title}</h1>
    ${session && html`<section class="panel paired">
      <p><b>${texts.paired_as.replace("{role}", () => roleText(session, texts))} (${session.person})</b></p>
      ${[["/referee", texts.referee_page], ...(session.role === "judge" ? [] : [["/box", texts.whole_box]])].map(([path, text]) => html`
        <p><a class="button ${path === ownPage(session) ? "next" : ""}" href=${address(path)}>${text}</a></p>`)}
      <p><button type="button" class="button" onClick=${end}>${texts.end_pairing}</button></p></section>`}
    <form class="panel" onSubmit=${pair}>
      <${Field} key=${link} name="code" text=${texts.code} value=${linked} autocapitalize="characters" />
      <${Field} name="person" text=${texts.your_name} value=${parameters.get("person") || localStorage.getItem(NAME) || ""} />
      <${Field} name="device" text=${texts.this_device} value=${deviceName()} />
      <button class="button next" disabled=${isBusy}>${texts.pair}</button>
    </form>
    <p class="quiet">${texts.pair_how}</p>
    ${isOpen && html`<p class="banner warning"><${Icon} name="warning" /><span>${texts.not_encrypted}</span></p>`}
    <${Missing} texts=${texts} />`;
}

show(Pair, ["page.words", "page.device_words"]);
