#!/usr/bin/env bash
# From a fresh clone to pictures: generates a power plant, builds its database, renders it and, from
# a terminal with a display, opens it in a window.
#
#   tools/demo.sh [TRIANGLES]                 default 2000000
#
# Everything it makes lies in out/: the model, the database, the pictures.
set -euo pipefail
cd "$(dirname "$0")/.."
triangles=${1:-2000000}
started=$SECONDS
say() { printf '\n[%d s] %s\n' $((SECONDS - started)) "$1"; }

say "Packages"
tools/install-packages.sh build
say "Building Pagoda"
cmake --preset release -DPAGODA_TESTS=OFF >/dev/null
cmake --build build-release --target pagoda
pagoda=build-release/tools/pagoda

mkdir -p out
say "A power plant of $triangles triangles"
"$pagoda" generate powerplant --triangles "$triangles" -o out/plant.glb --force
say "Its database"
"$pagoda" build out/plant.glb -o out/plant.pagoda --up z --force
"$pagoda" info out/plant.pagoda
"$pagoda" verify out/plant.pagoda

# Metres, z up. The same four places at every size of the model.
picture() {
    "$pagoda" render out/plant.pagoda -o "out/$1.png" --size 1280x720 --tau 1 --camera "$2"
}
say "Pictures"
picture site '{"eye":[-75,-105,55],"target":[65,35,15],"fovy":50}'
picture boiler-house '{"eye":[190,-70,30],"target":[85,30,18],"fovy":50}'
picture turbine-hall '{"eye":[3,3,10.2],"target":[50,20,9],"fovy":60}'
picture machine-room '{"eye":[90.5,6.6,9.6],"target":[81,11.5,9.2],"fovy":70}'

say "Done. Look at:"
for name in site boiler-house turbine-hall machine-room; do
    echo "  $PWD/out/$name.png"
done
if [ -n "${DISPLAY:-}" ] && [ -t 1 ]; then
    say "The window: F1 shows every key, Ctrl+Q closes it"
    "$pagoda" view out/plant.pagoda
else
    echo "  with a display: $pagoda view out/plant.pagoda"
fi
