"""The texts of the pages for paired devices: phones and tablets of referees and judges (docs/web.md, "Pairing")."""

from typing import Any, Dict

from roah_rsbb.model.actions import ACTIONS, ENTRIES, ROLES, Action, allowed
from roah_rsbb.model.reason import say
from roah_rsbb.wording import judging, schedule, sheets, stop, whole_box
from roah_rsbb.wording.language import tr, tr_later, tr_words

# Why a device is not paired.
NO_WEB = tr_later("the box serves no web pages: start it with web:=true")
TOO_MANY_GUESSES = tr_later("Too many wrong codes from this network: wait a minute, or scan the QR code of a new code")
WRONG_CODE = tr_later("This code is wrong, was used, or is older than two minutes: ask for a new one")
TOO_MANY_DEVICES = tr_later("Too many devices are paired: end some pairings first")
NO_NAME = tr_later("Type your name: it is recorded with everything that you enter")
NAME_IN_USE = tr_later("The name {name} is in use on another device ({device}): type another one. If that is your own "
                       "earlier pairing, ask an organiser to end it first (Teams)")
NOT_SAVED = tr_later("The pairing cannot be saved ({error}): free or repair the disk of log_dir")
ENDED_NOT_SAVED = say("Ended, but not saved ({error}): it would be valid again after a restart. Free or repair the "
                      "disk of log_dir, and try again")
# What it means that the pages are not encrypted.
NOT_ENCRYPTED = tr_later(
    "This connection is not encrypted: whoever can listen in this network can read and use it. Use a network of the "
    "referees only.")
# Why a command of a device has no effect.
NOT_ALLOWED = tr_later("This device may not do that: it is paired as {role}")
NO_ANSWER = tr_later("No answer from the box: it may have been done. Check the state")
# Why a team does not see its robot.
NO_PROTEST = tr_later("The team cannot object to this result: it needs its code, and the time must not be over")
WRONG_TEAM_CODE = tr_later("This code is wrong")
TOO_MANY_TEAM_GUESSES = tr_later("Too many wrong codes: wait a minute, then try again")
CODES_NOT_SAVED = say("The codes cannot be saved ({error}): free or repair the disk of log_dir")
# Why an organiser's setting of a display has no effect, or none after a restart.
NO_SUCH_DISPLAY = tr_later("This display is not connected")
TOO_MANY_DISPLAYS = tr_later("Too many displays are set: take some back first")
SETTING_NOT_SAVED = tr_later("The setting cannot be saved ({error}): free or repair the disk of log_dir")

# Keys of the window and the referee's page, and of the page.
SHARED_KEYS = (
    (tr_later("Esc twice"), tr_later("stop the run of the zone, wherever the focus is")),
    (tr_later("Shift+Esc twice"), tr_later("stop the runs of all zones")),
    (tr_later("1 to 9"), tr_later("score the item with this number: count one more, or yes")),
    (tr_later("Shift+1 to 9"), tr_later("take it back: count one less, or no")),
)
KEYS = (*SHARED_KEYS, ("?", tr_later("open or close this list")))


def role_text(role: str, zone: str) -> str:
    """Return a role and where it counts."""
    return tr("{role} in {zone}", role=tr(sheets.ROLES[role]), zone=zone) if zone else tr("{role}, all zones",
                                                                                  role=tr(sheets.ROLES[role]))


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


def page_words() -> Dict[str, Any]:
    """Return the fixed texts of the pages, by the names that the pages use. The pages fill their places."""
    return {
        **tr_words(
            # the whole box
            whole_box="Whole box", part_zone="Zone", part_overview="Now", part_schedule="Schedule",
            part_robots="Teams", part_devices="Home devices", part_runs="Results", part_log="Log", part_box="Box",
            part_pairings="Pairing", team="Team", all_teams="All teams", day="Day", all_days="All days",
            all_events="All events", no_events="No event fits these filters.", choose_event="Choose this event",
            leave_unsigned="{run} is not signed off. Its score sheet stays in Results.",
            hidden="{number} more are not shown", no_robot=whole_box.NO_ROBOT,
            no_robot_how="Each robot is listed here from its first message, with its link and its clock.",
            no_runs="This zone has no run yet.",
            no_runs_how="After Connect, a run is listed here with its score sheet, its history and its sign-off.",
            no_phone="No phone of a referee is connected", no_more_events="No more events",
            choose_or_filter="Choose or filter", nothing_to_come=(
                "No event is to come. Events of the schedule are listed here, with their estimated times."),
            waits="To do", look_at="Show", nothing_open=(
                "Nothing waits. Score sheets to sign off, objections and zones without a referee are listed here."),
            standings="Standings", no_standings="No run is signed off yet. Then the teams are ranked here.",
            reload_how="Compares the files of the competition with what is in force, and asks before anything changes.",
            history="History", ends="Ends", withdraw=ENTRIES["withdraw"].label, in_time=ENTRIES["in_time"].label,
            late=sheets.LATE, steps="How the points came about",
            still_connected="The run is still connected. Disconnect it first.", shown_text="Text", search="Search",
            matches="{number} lines", online="Online Data", no_log="Nothing has been logged yet",
            no_online="No online data from the robot yet", tablet="Tablet", no_tablet="The tablet was never heard",
            day_title="Change the day", day_what="What happens", day_how=(
                "Shift a late zone, swap, move or add events, withdraw a team. The effect is shown before anything "
                "changes."),
            show_effect="Show the effect", do_it="Do it", effect="This would change:", edits="Changes so far",
            no_edits="Nothing was changed yet.", undone="undone",
            reload="Reload", reload_title=whole_box.RELOAD, apply="Apply", reload_errors=whole_box.RELOAD_ERRORS,
            reload_apply=whole_box.RELOAD_APPLY, reload_same=whole_box.RELOAD_SAME,
            reload_rescored=whole_box.RELOAD_RESCORED, reload_for_all=whole_box.RELOAD_FOR_ALL,
            reload_done=whole_box.RELOAD_DONE,
            exit="Exit", exit_title=whole_box.END_QUESTION, exit_all=whole_box.ENDS_ALL, exit_now=whole_box.END_NOW,
            cancel="Cancel", exit_runs=whole_box.END_RUNS, box_ended="The box has ended",
            box_ended_how="Start it again on its computer. Runs that were in progress and this page then continue.",
            may_act_as="May act as", new_code="New code", code_old="The code is too old: press New code",
            scan_code="Scan the code with the device, or open {page} and type it. It is for one device.",
            type_code="Open {page} on the device and type the code. It is for one device.",
            valid_for="Valid for {time}", paired_devices="Paired devices", end_one="End pairing", keys="Keys",
            # pairing, teams and displays
            role_in_zone="{role} in {zone}", role_everywhere="{role}, all zones", pair_title="Pair this device",
            pair_how=(
                "A code comes from an organiser's page (Whole box, Teams), or from 'referee pair' in a terminal. It "
                "is valid for two minutes, for one device."),
            code="Code", your_name="Your name", this_device="This device", pair="Pair", paired_as="Paired: {role}",
            needs_certificate=(
                "Without encryption, browsers do not let this page keep the screen on in a run, open without a network "
                "or be installed. For that, organisers make a certificate: 'new_competition --certificate'"),
            needs_trust=(
                "This browser does not trust the certificate of the box, so this page does not open without a network "
                "and cannot be installed. Install phones.crt, which the organisers have, then open the page again"),
            end_pairing="End the pairing of this device", not_encrypted=NOT_ENCRYPTED, referee_page="Referee's page",
            our_robot="Our robot", team_code="Code of the team", see_robot="Show what the box sees of our robot",
            codes="Codes of the teams", new_codes="New codes", print="Print",
            codes_how="Each team sees its link and its clock on its own page with this code.",
            codes_for_all="Everybody sees the links and clocks of all teams (team_pages is all). Codes are not needed.",
            displays="Displays",
            displays_how=(
                "Each /display and /overlay that is open. What you set here counts until you take it back. Its address "
                "may give a display its name: /display?name=Hall"),
            for_organisers="This page is for organisers. Pair this device with the role organiser.",
            no_displays="No display is open, and none is set", not_connected="not connected",
            unlisted="Displays without a place in the list: {number}", show_names="Show the names on all displays",
            name="Name", unnamed="Without a name", show="Shows", language="Language", as_address="as its address says",
            take_back="Take back", since="since {time}", windows="{number} windows", all_zones="all zones",
            show_rotating="everything in turns", show_run="the run, explained", show_standings="the standings",
            show_schedule="the schedule", show_results="the results",
            overlay_run="the run, as soon as there is one", overlay_clock="only the clock",
            overlay_results="the newest result", overlay_caption="your own text", overlay_nothing="nothing",
            caption="Your own text", caption_how="Dr. Ada Byron | Head referee",
            # the state of the page
            not_paired="This device is not paired", zone="Zone",
            offline="NO LINK TO THE BOX since {time}. STOP and marks are sent until the box answers",
            superseded="ANOTHER BOX HAS TAKEN OVER: open the pages at {address}",
            not_current="This is the last known state. STOP works, marks wait for the box",
            zone_gone="{zone} is not in the schedule. This page shows {other} now",
            own_zone_gone="{zone} is not in the schedule. To use this device in another zone, pair it again",
            no_data="The web gateway cannot show this zone now: see its log. STOP works",
            failed="A part of this page has failed: {part}. STOP works. Reload the page",
            locked="Locked, because nobody has touched this page for a while. STOP works", unlock="Slide to unlock",
            others_quiet="No other zone needs its referee", close="Close", fill_in="Fill in the fields",
            really="Press again: {command}", state="State", commands="Commands", more="More",
            read_on="Read on", marks_sent="Marks: {number}, all sent",
            marks_waiting="Marks: {number}, {waiting} waiting",
            was_in_time="Was it in time?", points_in_all="points",
            timeline="Timeline", note_moment=ENTRIES["note"].label, add_text="Add text", no_timeline="No run yet",
            unheard="Marks may be waiting on the devices of {names}",
            older="Older entries, in the sheet of the run: {number}", captain="Captain",
            captain_name=ENTRIES["captain"].fields[0].label,
            captain_how="Read the sheet, then sign with a finger. Whoever refuses says why",
            comment="Comment", sign="Sign", refuse="Refuse to sign", clear="Clear", our_sheets="Our score sheets",
            nothing_to_read="Runs that are over are listed here, for the captain to read and sign.",
            proposals="Made before the sign-off, arrived after it. Who accepts one signs the new sheet",
            accept="Accept", drop="Drop", earlier="Earlier today",
            stop_ends="STOP ends the run. It reaches no robot", stop_reaches="STOP goes to {robot}",
            sheet="Score sheet", time="Time", connect_robot="Connect {robot}",
            # STOP
            stop="■ STOP", stop_all="■ STOP ALL", hold="hold",
            nothing_to_stop="No run is in progress, so there is nothing to stop", others_run=stop.OTHERS_RUN,
            cannot_stop=(
                "This device is not paired, so it cannot stop a robot. A paired device, the referees' table and the "
                "robot's emergency button can"),
            stays="Back does not leave this page while a run is in progress", not_stopped="STOP was refused: {reasons}",
            given_up="{zone}: STOP WAS NOT DELIVERED. Stop the robot by hand, or press STOP again",
            # what is entered
            switches="Switches that the robot changed", damaged="Damaged switches", confirm="Confirm", is_on="on",
            is_off="off", yes="Yes", no="No", not_attempted="Not attempted", note="Note",
            note_how="It goes with your next mark of this item", set="Set", value="Value of {item}",
            add="{item}: one more", subtract="{item}: one less", options="More for {item}", sending="sending {mark}",
            not_confirmed="NOT CONFIRMED: {mark}. It is sent again until the box answers",
            queued="{number} waiting",
            not_kept="This browser keeps nothing: leave the page open until the box has it",
            not_on_disks="NOT CONFIRMED: {mark}. The box has it, but it is not on all disks yet",
            refused="Refused: {what}: {reasons}", undo="Undo: {mark}", nothing_to_undo="Undo",
            put_right="Put the run right", move_to="Event",
            **{f"{name}_run": ENTRIES[name].label for name in ("annul", "move", "reopen", "undo")},
            stop_reason=ACTIONS["stop"].fields[0].label, save="Save", saved="Saved",
            unsigned="Score sheets to sign off", sign_off="Sign off", correct="Correct",
            ratings_of="Ratings of {judge}",
            not_a_judge="No rating is asked of {judge} now",
            # judges, and how a result becomes final
            own_sheet="Your score sheet", judges="Judges", submit="Submit the sheet",
            submitted_how="Your sheet is submitted and locked. The head referee can hand it back.",
            marks_wait="The box has not confirmed all marks yet",
            look_again="The head referee asks you to look again: {reason}", missing_judges=judging.MISSING,
            waived=judging.WAIVED, differences=judging.DIFFERENCES, differs=judging.DIFFERS, settle=judging.SETTLE,
            reason="Reason", settled_by=judging.SETTLED_BY, judges_more="Sheets of the judges",
            hand_back=judging.HAND_BACK, withdraw_sheet=judging.WITHDRAW, waive=judging.WAIVE,
            judges_score="Several judges score this run, each on a sheet of their own",
            publication="Provisional result and objections", publish=judging.PUBLISH,
            objection_time=judging.OBJECTION_TIME, object=judging.OBJECT, objection_by="Who objects",
            objection_at="Time of the run, such as 2:41", replay="Replay", protests="Objections",
            protest_run="Run",
            uphold=judging.UPHOLD, reject=judging.REJECT,
            no_answer="No answer from the box: check the network, and try again",
        ),
        "continue": tr("▶ Start again"), **{f"role_{name}": tr(text) for name, text in sheets.ROLES.items()},
        "schedule_shows": [[show.value, tr(show.value)] for show in schedule.Show if show is not schedule.Show.ALL],
        "schedule_columns": [tr(column) for column in schedule.COLUMNS],
        "robot_columns": [tr(column) for column in whole_box.ROBOT_COLUMNS],
        "robot_explanations": list(whole_box.column_explanations().values()),
        "key_list": [[tr(key), tr(text)] for key, text in KEYS],
        "may": {role: allowed(role) for role in ROLES},
        "actions": {name: action_words(action) for name, action in ACTIONS.items()},
        "stop_way": {way.value: tr(text) for way, text in stop.TEXTS.items()},
        "objection_times": list(map(list, judging.objection_times())),
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
    ARENAS, ROUNDS = tr_later("Arenas, where the rulebook asks"), tr_later("How often each team does each benchmark")
    DECISIONS = tr_later("Choices that the rules leave to people, separated by ';'")
    TEAM, PASSWORD = tr_later("Team, as the robot sends it"), tr_later("Password of the team")
    IN_PROGRESS, DONE, FAILED = tr_later("in progress"), tr_later("done"), tr_later("ended with status {status}")
    END, OPTIONAL = tr_later("End it"), tr_later("optional")
