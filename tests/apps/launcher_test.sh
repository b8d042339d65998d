#!/bin/sh
# Starts the launcher of the portable tarball under C libraries of several ages, and without a library that it needs.
# usage: launcher_test.sh LAUNCHER FOLDER
set -eu
launcher=$1
folder=$2/files  # alone is cleared
rm -rf "$folder"
mkdir -p "$folder/tar/bin" "$folder/tar/libexec" "$folder/system"
sed 's/^needed=.*/needed=2.38/' "$launcher" >"$folder/tar/bin/skinbench"
printf '#!/bin/sh\nprintf "%%s|" "$@"\nexit 7\n' >"$folder/tar/libexec/skinbench"
chmod +x "$folder/tar/bin/skinbench" "$folder/tar/libexec/skinbench"
ln -s "$folder/tar/bin/skinbench" "$folder/system/skinbench"

# expect LINES-OF-getconf LINES-OF-ldd STATUS TEXT: what a call says on both streams, and its status. The program's own
# status is 7.
expect() {
    printf '#!/bin/sh\n%s\n' "$1" >"$folder/system/getconf"
    printf '#!/bin/sh\n%s\n' "$2" >"$folder/system/ldd"
    chmod +x "$folder/system/getconf" "$folder/system/ldd"
    status=0
    said=$(PATH=$folder/system:$PATH "$folder/system/skinbench" bench 'two words' 2>&1) || status=$?
    [ "$status" = "$3" ] && [ "$said" = "$4" ] && return
    echo "with '$1' and '$2': status $status instead of $3, '$said' instead of '$4'"
    exit 1
}

refusal='skinbench: this program needs glibc 2.38 or newer, this system has'
help='build it there, see README.md'
for version in 2.38 2.41 2.100 3.0; do expect "echo glibc $version" 'exit 1' 7 'bench|two words|'; done
for version in 2.37 2.31 2.4 1.99; do expect "echo glibc $version" 'exit 1' 1 "$refusal $version; $help"; done
# No getconf: what ldd says. Alpine's says nothing of glibc.
expect 'exit 127' 'echo "ldd (Debian GLIBC 2.41-12) 2.41"' 7 'bench|two words|'
expect 'exit 127' 'echo "ldd (GNU libc) 2.17"' 1 "$refusal 2.17; $help"
expect 'exit 1' 'echo "musl libc (x86_64)" >&2; exit 1' 1 "$refusal another C library; $help"
# A library that the system lacks is named, by either program.
cp "$folder/tar/bin/skinbench" "$folder/tar/bin/skinview"
LC_ALL=C sed 's/libc\.so\.6/libq.so.6/g' /bin/sh >"$folder/tar/libexec/skinview"
chmod +x "$folder/tar/libexec/skinview"
ln -sf "$folder/tar/bin/skinview" "$folder/system/skinbench"
lacking='skinview: this system lacks libq.so.6; install it (Debian and Ubuntu: libopengl0 has libOpenGL.so.0)'
expect 'echo glibc 2.41' 'exit 1' 1 "$lacking"
echo "the launcher starts the program or says why not"
