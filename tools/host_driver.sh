#!/usr/bin/env bash
# Prints the words for bubblewrap that bring the host's NVIDIA driver into the root folder, a word on each line: device
# files, libraries, and the two files by which Vulkan's and EGL's loaders find them. Nothing where one of these is
# missing. The libraries lie in a folder of their own, so that none is left behind in the root.
# usage: tools/host_driver.sh [HOST]     (HOST: for tests, a folder instead of /, with the output of `ldconfig -p` in
# HOST/ldconfig.txt)
set -euo pipefail
host=${1:-}
inside=/run/host-driver

list_libraries() {
    if [ -n "$host" ]; then
        cat "$host/ldconfig.txt" 2>/dev/null || true
    else
        PATH=$PATH:/usr/sbin:/sbin ldconfig -p 2>/dev/null || true
    fi
}

# first_file PATTERN…: the first that is there and names its library without a folder.
first_file() {
    local file
    for file; do
        if [ -f "$file" ] && grep -q '"library_path"[[:space:]]*:[[:space:]]*"[^/"]*"' "$file"; then
            echo "$file"
            return
        fi
    done
}

[ -e "$host/dev/nvidiactl" ] || exit 0
declare -A libraries=()
while read -r name path; do
    [ -n "${libraries[$name]:-}" ] || libraries[$name]=$(realpath -e -- "$host$path" 2>/dev/null || true)
done < <(list_libraries | sed -n \
    's/^[[:space:]]*\(lib\(nvidia-\|GLX_nvidia\|EGL_nvidia\|GLESv2_nvidia\)[^ ]*\) (libc6,x86-64[^)]*) => \(.*\)$/\1 \3/p')
vulkan=$(first_file "$host"/etc/vulkan/icd.d/nvidia*.json "$host"/usr/share/vulkan/icd.d/nvidia*.json)
egl=$(first_file "$host"/etc/glvnd/egl_vendor.d/*nvidia*.json "$host"/usr/share/glvnd/egl_vendor.d/*nvidia*.json)
for needed in "${libraries[libGLX_nvidia.so.0]:-}" "${libraries[libEGL_nvidia.so.0]:-}" "$vulkan" "$egl"; do
    [ -n "$needed" ] || exit 0
done

for file in "$host"/dev/nvidia*; do
    [ -d "$file" ] || printf '%s\n' --dev-bind "$file" "${file#"$host"}"
done
for name in "${!libraries[@]}"; do
    [ -z "${libraries[$name]}" ] || printf '%s\n' --ro-bind "${libraries[$name]}" "$inside/$name"
done | paste - - - | sort | tr '\t' '\n'
printf '%s\n' --ro-bind "$vulkan" "$inside/vulkan.json" --ro-bind "$egl" "$inside/egl.json" \
    --setenv LD_LIBRARY_PATH "$inside" --setenv VK_ADD_DRIVER_FILES "$inside/vulkan.json" \
    --setenv __EGL_VENDOR_LIBRARY_FILENAMES "$inside/egl.json:/usr/share/glvnd/egl_vendor.d/50_mesa.json"
