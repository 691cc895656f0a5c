# Completes `rosrun roah_rsbb PROGRAM ARGUMENT...` and `roah-rsbb PROGRAM ARGUMENT...` in bash. The setup file of the
# workspace sources it; the Debian package installs it.

# The programs that people start. Launch files start the others; they are completed from their first letters.
_roah_rsbb_programs="capture check_ground_truth check_robot demo dummy_box dummy_robot dummy_tablet new_competition panel
  preflight protected_master reconnect referee replay results roah_devices_dummy rulebook
  standby"

_roah_rsbb_folder() {  # the folder with the programs
  local prefix folder IFS=:
  for prefix in ${CMAKE_PREFIX_PATH-} /usr; do
    folder=$prefix/lib/roah_rsbb
    [ ! -x "$folder/comm" ] || { echo "$folder"; return; }
  done
}

# Without the package's command of this name: start a program at once. rosrun takes longer to find most programs than
# they take to do their work.
# As with pip's command of this name, a program's name may have dashes: `roah-rsbb check-robot`.
type -P roah-rsbb >/dev/null || roah-rsbb() {
  local folder program=${1-}
  program=${program//-/_}
  folder=$(_roah_rsbb_folder)
  [ -n "$folder" ] && [ -x "$folder/$program" ] && [ ! -d "$folder/$program" ] || {
    echo "usage: roah-rsbb PROGRAM [ARGUMENT...]; the programs: ${_roah_rsbb_programs//[[:space:]]/ }" >&2
    return 2
  }
  "$folder/$program" "${@:2}"
}

_roah_rsbb_complete() {  # index of the word that is the program
  local at=$1 word=${COMP_WORDS[COMP_CWORD]} folder
  folder=$(_roah_rsbb_folder)
  if [ "$COMP_CWORD" -eq "$at" ]; then
    COMPREPLY=($(compgen -W "$_roah_rsbb_programs" -- "$word"))
    [ ${#COMPREPLY[@]} -gt 0 ] || COMPREPLY=($(compgen -W "$(ls "$folder" 2>/dev/null)" -- "$word"))
    return
  fi
  local program=${COMP_WORDS[at]} line=$COMP_LINE number
  [ -x "$folder/$program" ] || return
  # The program sees the line from its own name on.
  for ((number = 0; number < at; number++)); do
    line=${line#"${COMP_WORDS[number]}"}
    line=${line#"${line%%[![:space:]]*}"}
  done
  local point=$((COMP_POINT - ${#COMP_LINE} + ${#line})) IFS=$'\013'
  COMPREPLY=($(
    _ARGCOMPLETE_IFS=$IFS COMP_LINE=$line COMP_POINT=$point COMP_TYPE=$COMP_TYPE \
      _ARGCOMPLETE=1 _ARGCOMPLETE_COMP_WORDBREAKS=$COMP_WORDBREAKS _ARGCOMPLETE_SUPPRESS_SPACE=1 \
      "$folder/$program" 8>&1 9>/dev/null >/dev/null 2>&9
  ))
  [[ ${COMPREPLY-} != *[=/:] ]] || compopt -o nospace
}

_roah_rsbb_rosrun() {
  local at=1
  while [[ ${COMP_WORDS[at]} == -* ]]; do
    [[ ${COMP_WORDS[at]} != -p && ${COMP_WORDS[at]} != --prefix ]] || at=$((at + 1))
    at=$((at + 1))
  done
  if [[ ${COMP_WORDS[at]} == roah_rsbb && $COMP_CWORD -gt $at ]]; then
    _roah_rsbb_complete $((at + 1))
  else
    # ROS's own completion. It may not be loaded yet, and then takes the place of this function.
    declare -F _roscomplete_exe >/dev/null || . /usr/share/bash-completion/completions/rosrun 2>/dev/null
    complete -o bashdefault -o default -F _roah_rsbb_rosrun rosrun
    ! declare -F _roscomplete_exe >/dev/null || _roscomplete_exe
  fi
}

_roah_rsbb_command() {
  _roah_rsbb_complete 1
}

complete -o bashdefault -o default -F _roah_rsbb_rosrun rosrun
complete -o bashdefault -o default -F _roah_rsbb_command roah-rsbb
