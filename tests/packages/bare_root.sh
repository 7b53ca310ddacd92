# Sourced by try_packages.sh and try_containers.sh: a bare Debian 12, made by debootstrap. Needs root and the network.
# bare_root FOLDER
bare_root() {
  [ "$(id -u)" = 0 ] || { echo "debootstrap needs root" >&2; exit 2; }
  command -v debootstrap >/dev/null || { echo "install debootstrap first" >&2; exit 2; }
  local mirror=${TUMBLE_DEBIAN_MIRROR:-http://deb.debian.org/debian}
  debootstrap --variant=minbase --include=ca-certificates bookworm "$1" "$mirror" >"$1.log" 2>&1 || { tail -n 20 "$1.log" >&2; exit 1; }
  rm -f "$1.log"
  chmod 755 "$1"   # a folder of mktemp is open to root alone, and so would be /
  # The host's way to the archive: proxies, names, certificates.
  cp -r /etc/apt/apt.conf.d "$1/etc/apt/" 2>/dev/null || true
  local file
  for file in /etc/resolv.conf /etc/hosts; do [ -f "$file" ] && cp -L "$file" "$1$file"; done
  mkdir -p "$1/usr/local/share/ca-certificates"
  cp -r /usr/local/share/ca-certificates/. "$1/usr/local/share/ca-certificates/" 2>/dev/null || true
  cp -L /etc/ssl/certs/ca-certificates.crt "$1/etc/ssl/certs/" 2>/dev/null || true
}
