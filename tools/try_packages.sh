#!/usr/bin/env bash
# Installs the packages of a folder on an empty Debian 12, and takes a user's first steps there: try_packages.sh FOLDER.
# It needs root, debootstrap and the network. DEBIAN_MIRROR: where packages come from.
set -euo pipefail

packages="$(cd "$1" && pwd)"
root="$packages/debian"
tools="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"

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
echo 'APT::Get::Assume-Yes "true";' >"$root/etc/apt/apt.conf.d/90yes"
inside() { chroot "$root" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }
inside apt-get update -q >"$packages/apt.log"
inside sh -c 'apt-get install -q -y --no-install-recommends /packages/*.deb g++ cmake make pkg-config' >>"$packages/apt.log" 2>&1 ||
  { tail -n 20 "$packages/apt.log"; exit 1; }

echo "the demo:"
inside dartcast run /usr/share/doc/dartcast/examples/vessel.toml --steps 100 -o /try/vessel -q
inside ls /try/vessel/report.html
inside dartcast convert /try/vessel -o /try/vessel.vtkhdf

# The tasks of docs/start.md, by its own lines. The reader's surface is a cube of 20 mm.
"$tools/start_lines.py" "$root/try/start"
mkdir -p "$root/try/start/install/build/packages"
cp "$packages"/*.deb "$root/try/start/install/build/packages/"
task() {
  echo "docs/start.md, $1:"
  inside sh -c "cd /try/start/$1 && sh run.sh" >"$packages/$1.log" 2>&1 || { tail -n 20 "$packages/$1.log"; exit 1; }
  tail -n "$2" "$packages/$1.log"
}
task install 1
inside python3 - >"$root/try/start/surface/my.stl" <<'TEXT'
import dartcast as dc
mesh = dc.generate_box(cells=[1, 1, 1], size=[20.0, 20.0, 20.0])
solid = dc.solid_of_cells(mesh)
print("solid cube")
for a, b, c in solid.points[solid.triangles]:
    print("facet normal 0 0 0\nouter loop", *("vertex {} {} {}".format(*p) for p in (a, b, c)), "endloop\nendfacet", sep="\n")
print("endsolid cube")
TEXT
task surface 2
task deformation 0
task program 1
echo "the program with pkg-config:"
inside sh -c 'cd /try/start/program && g++ first.cpp $(pkg-config --cflags --libs dartcast) -o first && ./first'
echo "completion:"
inside bash -c 'source /usr/share/bash-completion/completions/dartcast && COMP_WORDS=(dartcast ru) COMP_CWORD=1 && _dartcast && echo "ru: ${COMPREPLY[*]}"'
