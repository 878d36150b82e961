# floor.sh: the version floor, to be sourced by scripts. A slot that is found good raises it to its own sequence
# (IMAGE_SEQUENCE of os-release, `build` of a bundle's manifest); no bundle below it is installed (docs/image.md).

# is_sequence TEXT: only digits, and few enough for the shell's arithmetic
is_sequence() {
	case $1 in '' | *[!0-9]*) return 1 ;; esac
	[ ${#1} -le 12 ]
}

# read_floor FILE: sets floor and floor_version. If no slot was ever found good, or the data partition was created anew,
# the running system is the floor, and the status is 1. If the file cannot be read, nobody knows the floor: status 2.
read_floor() {
	local line=
	floor='' floor_version=''
	[ ! -e "$1" ] || line=$(cat "$1") || return 2
	read -r floor floor_version <<-LINE
		$line
	LINE
	! is_sequence "$floor" || return 0
	floor=${IMAGE_SEQUENCE:-0} floor_version=$IMAGE_VERSION
	is_sequence "$floor" || floor=0
	return 1
}

# raise_floor FILE: raises it to the running system's sequence; never lowers it. What cannot be read or written stays as
# it is; then the status is not 0.
raise_floor() {
	is_sequence "${IMAGE_SEQUENCE:-}" || return 0
	local status=0
	read_floor "$1" || status=$?
	[ $status != 2 ] || return 2
	[ $status = 1 ] || [ "$IMAGE_SEQUENCE" -gt "$floor" ] || return 0
	echo "$IMAGE_SEQUENCE $IMAGE_VERSION" >"$1.new" && sync "$1.new" && mv "$1.new" "$1" && sync "${1%/*}"
}
