// What is public about a team. Its name is the end of the address.

import {Card, Line, html, parameters, show, troubleText, useEffect, useState} from "/assets/parts.js";
import {ask, reasonsText} from "/assets/device.js";

const ALL = "ALL";
const AGAIN_MS = 2000;
const DOCUMENTS = ["page.words", "page.device_words", "page.runs", "page.next", "page.results", "page.standings"];

function teamName() {
  try {
    return decodeURIComponent(location.pathname.split("/").pop());
  } catch (error) {
    return "";
  }
}

function Part({title, lines, nothing}) {
  return html`
    <section class="below">
      <h2>${title}</h2>
      <ul>${lines.map((line) => html`<${Line} line=${line} />`)}</ul>
      ${lines.length === 0 && html`<p class="nothing">${nothing}</p>`}
    </section>`;
}

// What the box knows of the team's robot: for everybody, or with the team's code, as the organisers want.
function Robot({name, live, texts, words}) {
  const [found, setFound] = useState(null);
  const [trouble, setTrouble] = useState("");
  const path = `teams/${encodeURIComponent(name)}`;
  const load = async () => {
    const answer = await ask("GET", `${path}?language=${encodeURIComponent(words.language)}`);
    setFound((before) => (answer.status === 200 ? answer.body : before && {...before, facts: null}));
  };
  useEffect(() => {
    let timer;
    let isOpen = true;
    const again = async () => {
      if (live.silentSince === null) {
        await load();
      } else {
        setFound((before) => before && {...before, facts: null});
      }
      timer = isOpen && setTimeout(again, AGAIN_MS);
    };
    again();
    return () => {
      isOpen = false;
      clearTimeout(timer);
    };
  }, []);
  const send = async (event) => {
    event.preventDefault();
    const code = new FormData(event.target).get("code");
    const answer = await ask("POST", path, {code, language: parameters.get("language") || words.language});
    setTrouble(answer.status === 200 ? "" : reasonsText(answer, texts));
    await load();
  };
  if (!found) {
    return null;
  }
  return html`
    <section class="below device robot">
      <h2>${texts.our_robot}</h2>
      ${found.is_allowed && html`
        <ul>${(found.facts || [words.waiting]).map((fact) => html`<li class="line">${fact}</li>`)}</ul>`}
      ${!found.is_allowed && html`
        <form onSubmit=${send}>
          <label for="code">${texts.team_code}</label>
          <input id="code" name="code" autocomplete="off" autocapitalize="characters" spellcheck=${false} required maxlength="20" />
          ${trouble && html`<p class="alarm" role="alert">${trouble}</p>`}
          <button>${texts.see_robot}</button>
        </form>`}
    </section>`;
}

function Team({live, words}) {
  const name = teamName();
  const isOurs = (line) => line.of_team === name || line.of_team === ALL;
  document.title = name;
  if (!live.data["page.runs"]) {
    return html`<h1 class="title">${name}</h1><p class="waiting">${words.waiting}</p>`;
  }
  const runs = live.data["page.runs"].runs.filter((run) => run.teams.includes(name));
  const following = live.data["page.next"].lines.filter(isOurs);
  const {results, provisional} = live.data["page.results"];
  const ours = results.filter(isOurs), early = provisional.filter(isOurs);
  const standings = live.data["page.standings"].standings
    .map((standing) => ({title: standing.title, lines: standing.lines.filter((line) => line.team === name || !line.team)}))
    .filter((standing) => standing.lines.some((line) => line.team));
  const trouble = troubleText(live, words);
  return html`
    ${trouble && html`<header class="alarm"><span role="alert">${trouble}</span></header>`}
    <h1 class="title">${name}</h1>
    ${runs.length > 0 && html`
      <section class="cards">
        <h2 class="unseen">${words.runs}</h2>
        ${runs.map((run) => html`<${Card} key=${run.zone} run=${run} live=${live} />`)}
      </section>`}
    ${![runs, following, ours, early, standings].some((found) => found.length) && html`
      <p class="nothing">${words.not_in_schedule}</p>`}
    <${Robot} key=${name} name=${name} live=${live} texts=${live.data["page.device_words"]} words=${words} />
    <${Part} title=${words.next} lines=${following} nothing=${words.no_events} />
    ${standings.map((standing) => html`<${Part} ...${standing} nothing="" />`)}
    <${Part} title=${words.results} lines=${ours} nothing=${words.no_results} />
    ${early.length > 0 && html`<${Part} title=${words.provisional} lines=${early} nothing="" />`}`;
}

show(Team, DOCUMENTS);
