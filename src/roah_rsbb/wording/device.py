"""The texts of the pages for paired devices: phones and tablets of referees and judges (docs/web.md, "Pairing")."""

from typing import Any, Dict

from roah_rsbb.model.actions import ACTIONS, ENTRIES, Action
from roah_rsbb.wording import judging, schedule, stop, whole_box
from roah_rsbb.wording.language import tr, tr_later

# The roles of devices, by the names in the ROS interface.
ROLES = {"referee": tr_later("Referee"), "judge": tr_later("Judge"), "organiser": tr_later("Organiser")}

# Why a device is not paired.
NO_WEB = tr_later("the box serves no web pages: start it with web:=true")
TOO_MANY_GUESSES = tr_later("Too many wrong codes from this network: wait a minute, or scan the QR code of a new code")
WRONG_CODE = tr_later("This code is wrong, was used, or is older than two minutes: ask for a new one")
TOO_MANY_DEVICES = tr_later("Too many devices are paired: end some pairings first")
NO_NAME = tr_later("Type your name: it is recorded with everything that you enter")
NAME_IN_USE = tr_later("The name {name} is in use on another device ({device}): type another one. If that is your own "
                       "earlier pairing, ask an organiser to end it first (Pairing)")
NOT_SAVED = tr_later("The pairing cannot be saved ({error}): free or repair the disk of log_dir")
# What it means that the pages are not encrypted.
NOT_ENCRYPTED = tr_later(
    "This connection is not encrypted: whoever can listen in this network can read and use it. Use a network of the "
    "referees only.")
# Why a command of a device has no effect.
NOT_ALLOWED = tr_later("This device may not do that: it is paired as {role}")
NO_ANSWER = tr_later("No answer from the core: it may have been done. Check the state")
# Why a team does not see its robot.
WRONG_TEAM_CODE = tr_later("This code is wrong")
TOO_MANY_TEAM_GUESSES = tr_later("Too many wrong codes: wait a minute, then try again")
CODES_NOT_SAVED = tr_later("The codes cannot be saved ({error}): free or repair the disk of log_dir")
# Why an organiser's setting of a display has no effect, or none after a restart.
NO_SUCH_DISPLAY = tr_later("This display is not connected")
TOO_MANY_DISPLAYS = tr_later("Too many displays are set: take some back first")
SETTING_NOT_SAVED = tr_later("The setting cannot be saved ({error}): free or repair the disk of log_dir")

# Keys of the referee's page.
KEYS = (
    (tr_later("Esc twice"), tr_later("stop the run of the zone, wherever the focus is")),
    (tr_later("Shift+Esc twice"), tr_later("stop the runs of all zones")),
    (tr_later("1 to 9"), tr_later("score the item with this number: count one more, or yes")),
    (tr_later("Shift+1 to 9"), tr_later("take it back: count one less, or no")),
    ("?", tr_later("open or close this list")),
)


def role_text(role: str, zone: str) -> str:
    """Return a role and where it counts."""
    return tr("{role} in {zone}", role=tr(ROLES[role]), zone=zone) if zone else tr("{role}, all zones",
                                                                                  role=tr(ROLES[role]))


def encryption_text(url: str) -> str:
    """Return what the user of a page must know of its connection; empty: nothing, because it is encrypted."""
    return "" if url.startswith("https:") else tr(NOT_ENCRYPTED)


def action_words(action: Action) -> Dict[str, Any]:
    """Return what a page needs to show an action, in the language of the reader."""
    return {
        "label": tr(action.label), "explanation": tr(action.explanation), "careful": action.careful,
        "leaves": action.leaves, "aims": action.aims, "row": action.row.value,
        "fields": [{**field.form(), "label": tr(field.label)} for field in action.fields],
    }


def box_words() -> Dict[str, Any]:
    """Return the fixed texts of the page of the whole box."""
    return {
        "whole_box": tr("Whole box"), "part_zone": tr("Zone"), "part_overview": tr("Overview"),
        "part_schedule": tr("Schedule"), "part_robots": tr("Robots"), "part_devices": tr("Devices"),
        "part_runs": tr("Results"), "part_log": tr("Log"), "part_box": tr("Core"), "part_pairings": tr("Pairing"),
        "team": tr("Team"), "all_teams": tr("All teams"), "day": tr("Day"), "all_days": tr("All days"),
        "all_events": tr("All events"),
        "no_events": tr("No event fits these filters."), "choose_event": tr("Choose this event"),
        "schedule_shows": [[show.value, tr(show.value)] for show in schedule.Show if show is not schedule.Show.ALL],
        "leave_unsigned": tr("{run} is not signed off. Its score sheet stays in Results.", run="{run}"),
        "hidden": tr("{number} more are not shown", number="{number}"),
        "no_robot": tr("No robot is heard"),
        "robot_columns": [tr(column) for column in whole_box.ROBOT_COLUMNS],
        "robot_explanations": list(whole_box.column_explanations().values()),
        "no_runs": tr("This zone has no run yet."), "history": tr("History"), "ends": tr("Ends"),
        "withdraw": tr(ENTRIES["withdraw"].label),
        "still_connected": tr("The run is still connected. Disconnect it first."),
        "shown_text": tr("Text"), "search": tr("Search"), "matches": tr("{number} lines", number="{number}"),
        "online": tr("Online Data"), "no_log": tr("Nothing has been logged yet"),
        "no_online": tr("No online data from the robot yet"),
        "tablet": tr("Tablet"), "no_tablet": tr("The tablet was never heard"),
        "reload": tr("Reload"), "reload_title": tr("Reload configuration"), "apply": tr("Apply"),
        "reload_errors": tr("Nothing was changed. Correct this first:"),
        "reload_apply": tr("Apply these changes? Connected runs keep what they began with."),
        "reload_same": tr("The files contain what is in force"), "reload_done": tr("The changes are in force"),
        "exit": tr("Exit"), "exit_title": tr(whole_box.END_QUESTION), "exit_all": tr(whole_box.ENDS_ALL),
        "exit_now": tr(whole_box.END_NOW), "cancel": tr("Cancel"), "exit_runs": tr(whole_box.END_RUNS, runs="{runs}"),
        "box_ended": tr("The box has ended"),
        "box_ended_how": tr("Start it again on its computer. Runs that were in progress and this page then continue."),
        "may_act_as": tr("May act as"), "new_code": tr("New code"),
        "code_old": tr("The code is too old: press New code"),
        "scan_code": tr("Scan the code with the device, or open {page} and type it. It is for one device.",
                        page="{page}"),
        "type_code": tr("Open {page} on the device and type the code. It is for one device.", page="{page}"),
        "valid_for": tr("Valid for {time}", time="{time}"), "paired_devices": tr("Paired devices"),
        "end_one": tr("End pairing"),
        "keys": tr("Keys"), "key_list": [[tr(key), tr(text)] for key, text in KEYS],
    }


def page_words() -> Dict[str, Any]:
    """Return the fixed texts of the pages, by the names that the pages use."""
    return {
        **box_words(), **{f"role_{name}": tr(text) for name, text in ROLES.items()},
        "role_in_zone": tr("{role} in {zone}", role="{role}", zone="{zone}"),
        "role_everywhere": tr("{role}, all zones", role="{role}"),
        "pair_title": tr("Pair this device"),
        "pair_how": tr("A code comes from an organiser's page (Whole box, Pairing), or from 'referee pair' "
                       "in a terminal. It is valid for two minutes, for one device."),
        "code": tr("Code"),
        "your_name": tr("Your name"),
        "this_device": tr("This device"),
        "pair": tr("Pair"),
        "paired_as": tr("Paired: {role}", role="{role}"),
        "end_pairing": tr("End the pairing of this device"),
        "not_encrypted": tr(NOT_ENCRYPTED),
        "referee_page": tr("Referee's page"),
        "our_robot": tr("Our robot"), "team_code": tr("Code of the team"),
        "see_robot": tr("Show what the box sees of our robot"),
        "codes": tr("Codes of the teams"), "new_codes": tr("New codes"), "print": tr("Print"),
        "codes_how": tr("Each team sees its link and its clock on its own page with this code."),
        "codes_for_all": tr(
            "Everybody sees the links and clocks of all teams (team_pages is all). Codes are not needed."),
        "displays": tr("Displays"), "displays_how": tr(
            "Each /display and /overlay that is open. What you set here counts until you take it back. Its address may "
            "give a display its name: /display?name=Hall"),
        "for_organisers": tr("This page is for organisers. Pair this device with the role organiser."),
        "no_displays": tr("No display is open, and none is set"), "not_connected": tr("not connected"),
        "unlisted": tr("Displays without a place in the list: {number}", number="{number}"),
        "show_names": tr("Show the names on all displays"), "name": tr("Name"), "unnamed": tr("Without a name"),
        "show": tr("Shows"), "language": tr("Language"), "as_address": tr("as its address says"),
        "take_back": tr("Take back"), "since": tr("since {time}", time="{time}"),
        "windows": tr("{number} windows", number="{number}"), "all_zones": tr("all zones"),
        "show_rotating": tr("everything in turns"), "show_run": tr("the run, explained"),
        "show_standings": tr("the standings"), "show_schedule": tr("the schedule"), "show_results": tr("the results"),
        "not_paired": tr("This device is not paired"),
        "zone": tr("Zone"),
        "offline": tr("NO LINK TO THE BOX since {time}. STOP is sent until the box answers", time="{time}"),
        "superseded": tr("ANOTHER BOX HAS TAKEN OVER: open the pages at {address}", address="{address}"),
        "not_current": tr("This is the last known state. STOP works"),
        "zone_gone": tr("{zone} is not in the schedule. This page shows {other} now", zone="{zone}", other="{other}"),
        "own_zone_gone": tr("{zone} is not in the schedule. To use this device in another zone, pair it again",
                            zone="{zone}"),
        "no_data": tr("The web gateway cannot show this zone now: see its log. STOP works"),
        "failed": tr("A part of this page has failed: {part}. STOP works. Reload the page", part="{part}"),
        "locked": tr("Locked, because nobody has touched this page for a while. STOP works"),
        "unlock": tr("Slide to unlock"),
        "others_quiet": tr("No other zone needs its referee"),
        "close": tr("Close"),
        "fill_in": tr("Fill in the fields"),
        "really": tr("Press again: {command}", command="{command}"),
        "state": tr("State"), "commands": tr("Commands"), "more": tr("More commands"),
        "sheet": tr("Score sheet"), "time": tr("Time"),
        "actions": {name: action_words(action) for name, action in ACTIONS.items()},
        "connect_robot": tr("Connect {robot}", robot="{robot}"),
        "continue": tr("▶ Continue the run"),
        "may_continue": tr("The rules allow a restart, which continues this run."),
        "stop": tr("■ STOP"), "stop_all": tr("■ STOP ALL"), "hold": tr("hold"),
        "stop_way": {way.value: tr(text, zone="{zone}") for way, text in stop.TEXTS.items()},
        "nothing_to_stop": tr("No run is in progress, so there is nothing to stop"),
        "others_run": tr(stop.OTHERS_RUN, zone="{zone}", zones="{zones}"),
        "cannot_stop": tr("This device is not paired, so it cannot stop a robot. A paired device, the referees' table "
                          "and the robot's emergency button can"),
        "stays": tr("Back does not leave this page while a run is in progress"),
        "not_stopped": tr("STOP was refused: {reasons}", reasons="{reasons}"),
        "given_up": tr("{zone}: STOP WAS NOT DELIVERED. Stop the robot by hand, or press STOP again", zone="{zone}"),
        "switches": tr("Switches that the robot changed"), "damaged": tr("Damaged switches"),
        "confirm": tr("Confirm"), "is_on": tr("on"), "is_off": tr("off"),
        "yes": tr("Yes"), "no": tr("No"), "not_attempted": tr("Not attempted"), "note": tr("Note"),
        "note_how": tr("It goes with your next mark of this item"), "set": tr("Set"),
        "value": tr("Value of {item}", item="{item}"), "add": tr("{item}: one more", item="{item}"),
        "subtract": tr("{item}: one less", item="{item}"), "options": tr("More for {item}", item="{item}"),
        "sending": tr("sending {mark}", mark="{mark}"),
        "not_confirmed": tr("NOT CONFIRMED: {mark}. It is sent again until the box answers", mark="{mark}"),
        "not_on_disks": tr("NOT CONFIRMED: {mark}. The box has it, but it is not on all disks yet", mark="{mark}"),
        "refused": tr("Refused: {what}: {reasons}", what="{what}", reasons="{reasons}"),
        "undo": tr("Undo: {mark}", mark="{mark}"), "nothing_to_undo": tr("Undo"),
        "stop_reason": tr("Reason for the stop"), "save": tr("Save"), "saved": tr("Saved"),
        "unsigned": tr("Score sheets to sign off"), "sign_off": tr("Sign off"), "correct": tr("Correct"),
        "ratings_of": tr("Ratings of {judge}", judge="{judge}"),
        "not_a_judge": tr("No rating is asked of {judge} now", judge="{judge}"),
        "own_sheet": tr("Your score sheet"), "judges": tr("Judges"), "submit": tr("Submit the sheet"),
        "submitted_how": tr("Your sheet is submitted and locked. The head referee can hand it back."),
        "marks_wait": tr("The box has not confirmed all marks yet"),
        "look_again": tr("The head referee asks you to look again: {reason}", reason="{reason}"),
        "missing_judges": tr(judging.MISSING, missing="{missing}", count="{count}"),
        "waived": tr(judging.WAIVED, reason="{reason}"),
        "differences": tr(judging.DIFFERENCES, number="{number}"),
        "differs": tr(judging.DIFFERS), "settle": tr(judging.SETTLE), "reason": tr("Reason"),
        "settled_by": tr(judging.SETTLED_BY, name="{name}", reason="{reason}"),
        "judges_more": tr("Sheets of the judges"), "hand_back": tr(judging.HAND_BACK),
        "withdraw_sheet": tr(judging.WITHDRAW), "waive": tr(judging.WAIVE),
        "judges_score": tr("Several judges score this run, each on a sheet of their own"),
        "publication": tr("Provisional result and objections"), "publish": tr(judging.PUBLISH),
        "objection_time": tr(judging.OBJECTION_TIME), "objection_times": list(map(list, judging.objection_times())),
        "object": tr(judging.OBJECT), "objection_by": tr("Who objects"),
        "uphold": tr(judging.UPHOLD), "reject": tr(judging.REJECT),
        "no_answer": tr("No answer from the box: check the network, and try again"),
    }


class StartWords:
    """The texts of the page to which `roah-rsbb` alone leads."""

    DEMO, RUN, NEW, CHECK = "demo", "run", "new", "check"

    TITLES: Dict[str, str] = {
        DEMO: tr_later("Demonstration"), RUN: tr_later("Run a competition"), NEW: tr_later("New competition"),
        CHECK: tr_later("Check a robot"),
    }
    EXPLANATIONS: Dict[str, str] = {
        DEMO: tr_later("A box with a dummy robot on this computer alone. The organiser's page opens."),
        RUN: tr_later("The box of a competition. The organiser's page opens. Runs continue where they were."),
        NEW: tr_later("Creates the folder of a competition: benchmarks, schedule, a password for each team."),
        CHECK: tr_later("Plays the box against a robot and reports what works. The robot moves: keep the emergency "
                        "stop at hand."),
    }
    BUTTONS: Dict[str, str] = {
        DEMO: tr_later("Start the demonstration"), RUN: tr_later("Start the box"), NEW: tr_later("Create it"),
        CHECK: tr_later("Check it"),
    }
    HOST = tr_later("Broadcast address of the robots' network")
    DEVICES = tr_later("Address of the home devices' controller (empty: they are off)")
    COMPETITION, NAME, RULEBOOK = tr_later("Competition"), tr_later("Name of the competition"), tr_later("Rulebook")
    TEAMS, DAYS = tr_later("Teams, separated by commas"), tr_later("Days")
    TEAM, PASSWORD = tr_later("Team, as the robot sends it"), tr_later("Password of the team")
    IN_PROGRESS, DONE, FAILED = tr_later("in progress"), tr_later("done"), tr_later("ended with status {status}")
    END, OPTIONAL = tr_later("End it"), tr_later("optional")
