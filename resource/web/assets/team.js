// What is public about a team. Its name is the end of the address.

import {Line, Standing, TeamMark, Trouble, Zone, html, parameters, secondsOf, show, troubleText, useEffect, useState} from "/assets/parts.js";
import {Captain, Facts, itemLines} from "/assets/captain.js";
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

const Part = ({title, lines, nothing}) => html`
  <section>
    <h2>${title}</h2>
    ${lines.length > 0 ? html`<ul class="panel lines">${lines.map((line) => html`<${Line} line=${line} />`)}</ul>`
    : html`<p class="panel empty quiet">${nothing}</p>`}
  </section>`;

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
    <section>
      <h2>${texts.our_robot}</h2>
      ${found.is_allowed ? html`
        <ul class="panel lines">${(found.facts || [words.waiting]).map((fact) => html`<li class="line">${fact}</li>`)}</ul>` : html`
        <form class="panel" onSubmit=${send}>
          <label for="code">${texts.team_code}</label>
          <input id="code" name="code" autocomplete="off" autocapitalize="characters" spellcheck=${false} required maxlength="20" />
          <${Trouble} text=${trouble} />
          <button class="button">${texts.see_robot}</button>
        </form>`}
    </section>
    <${Protests} name=${name} found=${found.protests} load=${load} texts=${texts} words=${words} />
    ${found.runs && html`
      <section>
        <h2>${texts.our_sheets}</h2>
        ${found.runs.length > 0 ? html`<ul class="panel lines">${found.runs.map((run) => html`
          <${OwnSheet} key=${run.identity} path=${path} run=${run} texts=${texts} words=${words} />`)}</ul>`
          : html`<p class="panel empty quiet">${texts.nothing_to_read}</p>`}
      </section>`}`;
}

// What the team objects to, and what became of it. `found`: see ProtestHandler.
function Protests({name, found, load, texts, words}) {
  const [trouble, setTrouble] = useState("");
  if (!found || !(found.runs.length || found.objections.length)) {
    return null;
  }
  const send = async (event) => {
    event.preventDefault();
    const form = event.target, entered = new FormData(form);
    const answer = await ask("POST", `teams/${encodeURIComponent(name)}/protest`, {
      identity: entered.get("run"), text: entered.get("text"), second: secondsOf(entered.get("at")), language: parameters.get("language") || words.language});
    setTrouble(answer.status === 200 ? "" : reasonsText(answer, texts));
    if (answer.status === 200) {
      form.reset();
    }
    await load();
  };
  return html`
    <section>
      <h2>${texts.protests}</h2>
      ${found.objections.length > 0 && html`<ul class="panel lines">${found.objections.map((one) => html`
        <li class="line">${one.title}: ${one.text} – <strong>${one.answer}</strong></li>`)}</ul>`}
      ${found.runs.length > 0 && html`
        <form class="panel" onSubmit=${send}>
          <label for="run">${texts.protest_run}</label>
          <select id="run" name="run" required>${found.runs.map((run) => html`<option value=${run.identity}>${run.title}, ${run.until}</option>`)}</select>
          <label for="text">${texts.reason}</label><input id="text" name="text" required maxlength="300" autocomplete="off" />
          <label for="at">${texts.objection_at}</label>
          <input id="at" name="at" maxlength="7" pattern="[0-9]+(:[0-9]{2})?" autocomplete="off" />
          <${Trouble} text=${trouble} />
          <button class="button">${texts.object}</button>
        </form>`}
    </section>`;
}

// The score sheet of a run of the team, which its captain reads and signs.
function OwnSheet({path, run, texts, words}) {
  const [sheet, setSheet] = useState(null);
  const [isOpen, setOpen] = useState(false);
  const [trouble, setTrouble] = useState("");
  const send = async (given) => {
    const answer = await ask("POST", `${path}/sheet`, {identity: run.identity, language: words.language, ...given});
    const isDone = answer.status === 200;
    setTrouble(isDone ? "" : reasonsText(answer, texts));
    setSheet(isDone ? answer.body : sheet);
    return isDone;
  };
  useEffect(() => {
    isOpen && send();
  }, [isOpen, run.revision]);
  return html`
    <li class="line own-sheet">
      <button type="button" class="button" aria-expanded=${isOpen} onClick=${() => setOpen(!isOpen)}>${run.title}<small>${[run.score, run.sheet].filter(Boolean).join(" · ")}</small></button>
      <${Trouble} text=${isOpen && trouble} />
      ${isOpen && sheet && html`
        <p class="quiet">${sheet.facts.join(" · ")}</p>
        <${Facts} lines=${[...itemLines(sheet.items), ...sheet.module]} />
        <p>${sheet.points}</p>
        <ul>${sheet.steps.map((step) => html`<li key=${step} class="quiet">${step}</li>`)}</ul>
        <${Captain} signs=${sheet.captain} texts=${texts} act=${send} />`}
    </li>`;
}

function Team({live, words}) {
  const name = teamName();
  const isOurs = (line) => line.of_team === name || line.of_team === ALL;
  document.title = name;
  const runs = live.data["page.runs"].runs.filter((run) => run.teams.includes(name));
  const following = live.data["page.next"].lines.filter(isOurs);
  const {results, provisional} = live.data["page.results"];
  const ours = results.filter(isOurs), early = provisional.filter(isOurs);
  const standings = live.data["page.standings"].standings
    .filter(({ranks}) => ranks.some(({team}) => team === name))
    .map((standing) => ({...standing, notes: standing.notes.filter(({team}) => !team || team === name)}));
  return html`
    <${Trouble} text=${troubleText(live, words)} />
    <header class="head"><${TeamMark} team=${name} live=${live} /><h1>${name}</h1></header>
    ${runs.length > 0 && html`
      <section class="zones">
        <h2 class="unseen">${words.runs}</h2>
        ${runs.map((run) => html`<${Zone} key=${run.zone} run=${run} live=${live} />`)}
      </section>`}
    ${![runs, following, ours, early, standings].some((found) => found.length) && html`
      <p class="panel empty quiet">${words.not_in_schedule}</p>`}
    <${Robot} key=${name} name=${name} live=${live} texts=${live.data["page.device_words"]} words=${words} />
    <${Part} title=${words.next} lines=${following} nothing=${words.no_events} />
    ${standings.map((standing) => html`
      <section><h2>${standing.title}</h2><div class="panel"><${Standing} standing=${standing} words=${words} live=${live} current=${name} /></div></section>`)}
    <${Part} title=${words.results} lines=${ours} nothing=${words.no_results} />
    ${early.length > 0 && html`<${Part} title=${words.provisional} lines=${early} nothing="" />`}`;
}

show(Team, DOCUMENTS);
