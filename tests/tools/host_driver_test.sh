#!/usr/bin/env bash
# tools/host_driver.sh over an invented host.     usage: host_driver_test.sh REPOSITORY FOLDER
set -euo pipefail
script=$1/tools/host_driver.sh
host=$2/files  # alone is cleared
libraries=$host/usr/lib64

fail() {
    echo "host_driver_test.sh: $*" >&2
    exit 1
}

has() { grep -qxF -- "$2" <<<"$1" || fail "'$2' is missing in: $1"; }

rm -rf "$host"
mkdir -p "$host/dev/nvidia-caps" "$libraries" "$host/etc/vulkan/icd.d" "$host/usr/share/glvnd/egl_vendor.d"
[ -z "$("$script" "$host")" ] || fail "a host without the driver gives words"

touch "$host/dev/nvidiactl" "$host/dev/nvidia0"
for name in libGLX_nvidia libEGL_nvidia; do
    echo library >"$libraries/$name.so.550.1"
    ln -s "$name.so.550.1" "$libraries/$name.so.0"
done
echo library >"$libraries/libnvidia-glcore.so.550.1"
vulkan=$host/etc/vulkan/icd.d/nvidia_icd.json
egl=$host/usr/share/glvnd/egl_vendor.d/10_nvidia.json
echo '{"ICD": {"library_path": "libGLX_nvidia.so.0"}}' >"$vulkan"
echo '{"ICD": {"library_path" : "libEGL_nvidia.so.0"}}' >"$egl"
[ -z "$("$script" "$host")" ] || fail "a host without libraries gives words"
cat >"$host/ldconfig.txt" <<LIST
4 libs found in cache
	libGLX_nvidia.so.0 (libc6) => /usr/lib/libGLX_nvidia.so.0
	libGLX_nvidia.so.0 (libc6,x86-64) => /usr/lib64/libGLX_nvidia.so.0
	libEGL_nvidia.so.0 (libc6,x86-64, OS ABI: Linux 2.3.99) => /usr/lib64/libEGL_nvidia.so.0
	libnvidia-glcore.so.550.1 (libc6,x86-64) => /usr/lib64/libnvidia-glcore.so.550.1
	libnvidia-gone.so.1 (libc6,x86-64) => /usr/lib64/libnvidia-gone.so.1
	libc.so.6 (libc6,x86-64) => /usr/lib64/libc.so.6
LIST

words=$("$script" "$host")
lines=$(wc -l <<<"$words")
[ "$lines" = 30 ] || fail "$lines words instead of 30: $words"
for word in "$host/dev/nvidia0" /dev/nvidiactl "$libraries/libGLX_nvidia.so.550.1" /run/host-driver/libGLX_nvidia.so.0 \
    /run/host-driver/libEGL_nvidia.so.0 /run/host-driver/libnvidia-glcore.so.550.1 "$vulkan" "$egl" LD_LIBRARY_PATH; do
    has "$words" "$word"
done
# Files that name a library by its folder would not find it inside.
echo '{"ICD": {"library_path": "/usr/lib64/libEGL_nvidia.so.0"}}' >"$egl"
[ -z "$("$script" "$host")" ] || fail "a host whose EGL file names a folder gives words"
