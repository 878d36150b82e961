# apt.sh: to be sourced. apt for packages of any architecture and mirror, with lists and status of its own: nothing of
# this machine changes, and nothing of this machine decides what is chosen.

# apt_from MIRROR [COMPONENTS]: prints Debian 12's lists of packages at this mirror, as sources.list has them. A % in it stands for
# debian or debian-security, as a date of snapshot.debian.org needs; such lists stay valid for ever.
apt_from() {
	local key=/usr/share/keyrings/debian-archive-keyring.gpg mirror=$1 ever=
	case $mirror in
	*%*) ever=' check-valid-until=no' ;;
	*) mirror=$mirror/% ;;
	esac
	printf "deb [signed-by=$key$ever] %s ${2:-main}\n" "${mirror//%/debian} bookworm" "${mirror//%/debian} bookworm-updates" \
		"${mirror//%/debian-security} bookworm-security"
}

# apt_start FOLDER ARCH MIRROR [COMPONENTS]: fetches the lists into the folder; the status is that of apt-get
apt_start() {
	rm -rf "$1"
	mkdir -p "$1"/{lists,cache/archives}/partial
	apt_from "$3" "${4:-main}" >"$1/sources.list"
	echo "$2" >"$1/arch"
	: >"$1/status"
	apt_in "$1" get -qq update
}

# apt_in FOLDER get|cache WORDS...: runs apt-get or apt-cache with what apt_start fetched
apt_in() {
	local folder=$1 tool=apt-$2 arch
	arch=$(cat "$folder/arch")
	shift 2
	folder=$(cd "$folder" && pwd)
	"$tool" -o APT::Architecture="$arch" -o APT::Architectures::="$arch" -o APT::Install-Recommends=false \
		-o APT::Sandbox::User= -o Debug::NoLocking=true -o Dir::State::lists="$folder/lists" \
		-o Dir::State::status="$folder/status" -o Dir::Cache="$folder/cache" \
		-o Dir::Etc::sourcelist="$folder/sources.list" -o Dir::Etc::sourceparts=/dev/null "$@"
}
