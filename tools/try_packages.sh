#!/usr/bin/env bash
# Installs the packages of a folder on an empty Debian 12, and takes a user's first steps there: try_packages.sh FOLDER.
# It needs root, debootstrap and the network. DEBIAN_MIRROR: where packages come from.
set -euo pipefail

packages="$(cd "$1" && pwd)"
root="$packages/debian"

cleanup() { umount "$root/proc" 2>/dev/null || true; }
trap cleanup EXIT

if [[ ! -d "$root/usr/share/doc" ]]; then
  debootstrap --variant=minbase bookworm "$root" "${DEBIAN_MIRROR:-http://deb.debian.org/debian}" >"$packages/debootstrap.log" ||
    { tail -n 20 "$packages/debootstrap.log"; exit 1; }
fi
mount -t proc proc "$root/proc"
rm -rf "$root/packages" "$root/try"
mkdir -p "$root/packages" "$root/try"
cp "$packages"/*.deb "$root/packages/"
cp /etc/apt/apt.conf.d/*proxy* "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
inside() { chroot "$root" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }
inside apt-get update -q >"$packages/apt.log"
inside sh -c 'apt-get install -q -y --no-install-recommends /packages/*.deb g++ pkg-config' >>"$packages/apt.log" 2>&1 ||
  { tail -n 20 "$packages/apt.log"; exit 1; }

echo "the demo:"
inside dartcast run /usr/share/doc/dartcast/examples/vessel.toml --steps 100 -o /try/vessel -q
inside ls /try/vessel/report.html
echo "Python:"
inside python3 -c 'import dartcast as dc; print("dartcast", dc.__version__, dc.Environment(dc.generate_bar()).validity().valid)'
echo "a program with pkg-config:"
cat >"$root/try/first.cpp" <<'TEXT'
#include <cstdio>
#include "dartcast/dartcast.hpp"
int main() {
  dartcast::Environment environment(dartcast::generate_bar());
  dartcast::Simulation simulation(environment, {.dt = 0.1, .response = dartcast::Reflect{0.5}});
  simulation.add({{2.5, 2.5, 14.0}}, {30.0, 0.0, 1.0});
  for (const auto& c : simulation.step().contacts()) std::printf("t = %.3f at x = %.3f\n", c.time_of_impact, c.point.x);
}
TEXT
inside sh -c 'cd /try && g++ first.cpp $(pkg-config --cflags --libs dartcast) -o first && ./first'
