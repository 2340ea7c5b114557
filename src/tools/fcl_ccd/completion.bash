# bash completion of fcl-ccd                                       -*- shell-script -*-

_fcl_ccd() {
  local word=$2 previous=$3 command=${COMP_WORDS[1]-}
  local common='--help --toc-err --repeat --json'
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W 'run candidates queries compare --help --version' -- "$word")
    return
  fi
  local words=
  case $previous in
    --query) words='all first any' ;;
    --kind) words='vf ee' ;;
    --columns)
      case $command in
        run)
          words='triangles position normal triangles,position,normal step,kind,i0,i1,i2,i3,i4,toc_lo,toc_hi
            step kind i0 i1 i2 i3 i4 toc_lo toc_hi t0 t1 x y z nx ny nz'
          ;;
        candidates) words='kind,i0,i1,i2,i3,t_lo,t_hi kind i0 i1 i2 i3 t_lo t_hi t0 t1' ;;
        queries) words='index,answer,toc_lo,toc_hi index answer toc_lo toc_hi kind truth toc not_doubles file' ;;
      esac
      ;;
    --start | --end | --stride | --follow | --thickness | --jobs | --threads | --toc-err | --repeat | --at-step | --at-time) return ;;
    *)
      case $command:$word in
        run:-*)
          words="$common --against --start --end --stride --follow --no-self --query --thickness
            --ignore-initially-closer --jobs --threads --weld --contacts --columns --steps --resume --report
            --picture --paint --at-step --at-time"
          # A scene takes some of them.
          [[ ${COMP_WORDS[2]-} != *.json ]] ||
            words='--help --query --toc-err --threads --contacts --json --start --end'
          ;;
        candidates:-*) words='--help --against --no-self --thickness --weld --output --columns' ;;
        compare:-*) words="$common --kind --truth" ;;
        queries:-*) words="$common --kind --print --columns" ;;
        *)
          compopt -o filenames
          mapfile -t COMPREPLY < <(compgen -f -- "$word")
          return
          ;;
      esac
      ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -F _fcl_ccd fcl-ccd
