#!/bin/bash
# systemd as PID 1 of a machine of its own, without a disk: boot_systemd.sh ROOT TREE SITE BASE
#   ROOT  an empty folder    TREE  this project    SITE  site-packages    BASE  where its Python is installed
# It has this machine's /usr, network and terminal lines, and of systemd's own units only those named below.
set -euo pipefail
root=$1 tree=$2 site=$3 base=$4
python=$(basename "$(dirname "$site")")

umask 022 # services without rights read what is made here

if [[ ${5:-} != inside ]]; then # a control group for all of it, which the last lines take away; SIGTERM ends it
    inside=
    trap '[[ -z $inside ]] || kill -KILL "$inside" 2> /dev/null || true' TERM
    mount --make-rprivate /
    mount -t cgroup2 cgroup2 "$root"
    group=$root/mavhelm-test-$$
    mkdir "$group"
    (
        echo "$BASHPID" > "$group/cgroup.procs"
        exec setpriv --pdeathsig KILL unshare --pid --cgroup --mount --uts --ipc --fork --kill-child \
            bash "$0" "$root" "$tree" "$site" "$base" inside
    ) &
    inside=$!
    while kill -0 "$inside" 2> /dev/null; do wait "$inside" || true; done # a trap ends `wait` before its time
    for attempt in {1..100}; do # who was killed is gone a moment later
        find "$group" -depth -type d -exec rmdir {} + 2> /dev/null && break
        sleep 0.05
    done
    exit
fi

mount -t tmpfs -o mode=755 tmpfs "$root"
cd "$root"
mkdir -p usr etc/systemd/system dev home opt/python opt/rover/bin "opt/rover/lib/$python/site-packages" \
    opt/site opt/tree proc root run sys tmp var/lib var/tmp
mount --bind -o ro /usr usr
for each in bin sbin lib lib32 lib64 libx32; do
    if [[ -L /$each ]]; then cp -P "/$each" .; elif [[ -d /$each ]]; then mkdir "$each" && mount --bind -o ro "/$each" "$each"; fi
done

units=usr/lib/systemd/system
for folder in $units usr/lib/systemd/system-generators; do mount -t tmpfs tmpfs $folder; done
for unit in basic.target sysinit.target local-fs.target local-fs-pre.target network.target paths.target shutdown.target \
    slices.target sockets.target swap.target timers.target umount.target \
    systemd-journald.service systemd-journald.socket systemd-journald-dev-log.socket; do
    cp "/$units/$unit" $units/
done
mkdir $units/sockets.target.wants
ln -s ../systemd-journald{,-dev-log}.socket -t $units/sockets.target.wants

mount -t proc proc proc
mount --bind proc/sys proc/sys
mount -o remount,bind,ro proc/sys
mount -t sysfs -o ro sysfs sys
mount -t cgroup2 cgroup2 sys/fs/cgroup
mount -t tmpfs -o mode=755 tmpfs run
mount -t tmpfs -o mode=1777 tmpfs tmp
mount -t tmpfs -o mode=755 tmpfs dev # a mount, else systemd mounts all devices of this machine there
for node in null zero full random urandom tty; do touch dev/$node && mount --bind /dev/$node dev/$node; done
mkdir dev/pts dev/shm
mount --bind /dev/pts dev/pts

printf 'root:x:0:0:root:/root:/bin/sh\n' > etc/passwd
printf 'root:x:0:\ntty:x:5:\ndialout:x:20:\n' > etc/group
printf 'passwd: files systemd\ngroup: files systemd\nhosts: files\n' > etc/nsswitch.conf
printf '127.0.0.1 localhost\n' > etc/hosts
printf '%032d\n' 1 > etc/machine-id
touch etc/os-release
[[ -e /etc/ld.so.cache ]] && cp /etc/ld.so.cache etc/

# A virtual environment as `python3 -m venv /opt/rover` makes one, with what this one holds.
mount --bind -o ro "$tree" opt/tree
mount --bind -o ro "$site" opt/site
home=$base
if [[ $base != /usr* ]]; then mount --bind -o ro "$base" opt/python && home=/opt/python; fi
printf 'home = %s/bin\ninclude-system-site-packages = false\n' "$home" > opt/rover/pyvenv.cfg
ln -s "$home/bin/$python" opt/rover/bin/python3
printf '/opt/site\n/opt/tree\n' > "opt/rover/lib/$python/site-packages/rover.pth"

mkdir old
pivot_root . old
umount -l old
rmdir old
exec env -i container=mavhelm-test PATH=/usr/sbin:/usr/bin:/sbin:/bin /usr/lib/systemd/systemd --unit=basic.target < /dev/null
