#!/usr/bin/env bash
# Tries Baton the way a newcomer meets it: on a bare Debian 12 that has git and nothing else, from a clone of this checkout
# (what is committed, nothing besides). Packages, name server, proxy and certificates are those the host's apt, npm and
# resolver already use, so it works behind a private mirror.
#
#   tests/support/fresh_root.sh [--base ARCHIVE] FOLDER [COMMAND...]
#
# FOLDER must not exist; the root file system is made there and stays for inspection. COMMAND (deploy/baton test when
# none is given) runs as root in the clone, and its exit code is the script's. ARCHIVE, a tar file, keeps the bare system
# between trials: used when it exists, made when it does not. Needs root, debootstrap and, behind it, a Debian mirror.
set -euo pipefail

readonly kRelease=bookworm

die() {
  echo "fresh_root: $*" >&2
  exit 2
}

# The mounts live in a namespace of their own: whatever ends the script, the kernel takes them away with it.
if [[ -z ${FRESH_ROOT_INSIDE:-} ]]; then
  [[ $EUID == 0 ]] || die "must run as root (it mounts and calls chroot)"
  command -v debootstrap >/dev/null || die "debootstrap is missing: apt-get install debootstrap"
  FRESH_ROOT_INSIDE=1 exec unshare --mount "$BASH" "$0" "$@"
fi

base=
if [[ ${1:-} == --base ]]; then
  base=${2:?--base wants a file name}
  shift 2
fi
[[ $# -ge 1 && $1 != -* ]] || die "usage: fresh_root.sh [--base ARCHIVE] FOLDER [COMMAND...]"
root=$1
shift
[[ $# -gt 0 ]] || set -- deploy/baton test
[[ ! -e $root ]] || die "$root exists already; remove it or name another folder"
checkout=$(git -C "$(dirname "$(readlink -f "$0")")" rev-parse --show-toplevel)

# The host's Debian sources, as apt understood them: one "URI suite component" a line.
sources=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Identifier: Packages' |
  sed -nE "s/^Debian (.*)/\1/p" | sed "s/ $(. /etc/os-release && echo "$VERSION_CODENAME")/ $kRelease/" | sort -u)
mirror=$(awk -v suite=$kRelease '$2 == suite { print $1; exit }' <<<"$sources")
[[ -n $mirror ]] || die "found no Debian mirror in the host's apt sources (run apt-get update first)"

environment=(HOME=/root USER=root LANG=C.UTF-8 TERM="${TERM:-dumb}" PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin)
for name in http_proxy https_proxy no_proxy; do
  [[ -z ${!name:-} ]] || environment+=("$name=${!name}")
done
if command -v npm >/dev/null; then
  environment+=("npm_config_registry=$(cd / && npm config get registry 2>/dev/null)")
fi

# So do the processes: none outlives the command, or this script. The shell is there to be process 1 and reap.
inRoot() {
  env -i "${environment[@]}" setpriv --pdeathsig KILL unshare --pid --fork --kill-child --mount-proc="$root/proc" \
    chroot "$root" sh -c '[ ! -d /root/baton ] || cd /root/baton; "$@"; exit $?' sh "$@"
}

mkdir -p "$root"
if [[ -n $base && -e $base ]]; then
  tar -C "$root" -xf "$base"
else
  debootstrap --variant=minbase $kRelease "$root" "$mirror"
fi

cp --remove-destination "$(readlink -f /etc/resolv.conf)" "$root/etc/resolv.conf"
sed 's/^/deb /' <<<"$sources" >"$root/etc/apt/sources.list"
apt-config dump Acquire | grep -E '^Acquire::(http|https|Check-[^:]*)(:|::.*| )' >"$root/etc/apt/apt.conf.d/90host" || true
mkdir -p "$root/usr/local/share/ca-certificates" "$root/etc/ssl/certs"
cp -rT /usr/local/share/ca-certificates "$root/usr/local/share/ca-certificates"
[[ ! -e /etc/ssl/certs/ca-certificates.crt ]] || cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"

mount --rbind /dev "$root/dev"
mount -t tmpfs tmpfs "$root/dev/shm"

if [[ ! -x $root/usr/bin/git ]]; then
  inRoot apt-get update -q
  inRoot env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends git ca-certificates
  inRoot apt-get clean
  [[ -z $base ]] || tar -C "$root" --one-file-system -cf "$base" .
fi

git clone --quiet --no-hardlinks "$checkout" "$root/root/baton"
inRoot "$@"
