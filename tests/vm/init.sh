#!/bin/busybox sh
# The first program of the virtual machine: loads the modules, takes this machine's file system as read-only root with
# a layer in memory above it, makes the pins and the I2C bus, and starts systemd with one unit that runs the tests.
/bin/busybox --install -s /bin
mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t devtmpfs dev /dev
. /vm.env

for module in $MODULES; do
    case $module in
        i2c-stub) insmod /modules/$module.ko chip_addr=0x40 ;;  # a PCA9685's registers, without the chip behind them
        *) insmod /modules/$module.ko ;;
    esac || echo "vm: $module was not loaded"
done

mount -t 9p -o trans=virtio,version=9p2000.L,ro,cache=loose,msize=262144 host /host
mount -t tmpfs layer /layer
mkdir /layer/upper /layer/work
mount -t overlay -o lowerdir=/host,upperdir=/layer/upper,workdir=/layer/work root /root

# The header of a Pi: 54 lines of /dev/gpiochip0.
mount -t configfs config /sys/kernel/config
mkdir -p /sys/kernel/config/gpio-sim/pi/header
echo 54 > /sys/kernel/config/gpio-sim/pi/header/num_lines
echo 1 > /sys/kernel/config/gpio-sim/pi/live

# gpiozero asks which Pi this is: a Pi 3 B.
cat /proc/cpuinfo > /root/etc/vm-cpuinfo
echo "Revision : a02082" >> /root/etc/vm-cpuinfo

# Nothing of this machine's own services starts there.
: > /root/etc/fstab
rm -rf /root/etc/systemd/system/*.wants /root/etc/systemd/system/*.requires
for unit in systemd-tmpfiles-setup systemd-tmpfiles-setup-dev systemd-udevd systemd-udev-trigger systemd-sysusers \
    systemd-journal-flush systemd-modules-load systemd-sysctl systemd-update-utmp systemd-logind; do
    ln -sf /dev/null /root/etc/systemd/system/$unit.service
done
mount -t tmpfs tmp /root/tmp
cp /vm-tests.service /vm-tests.target /root/etc/systemd/system/
ln -sf vm-tests.target /root/etc/systemd/system/default.target
umount /proc
mount --move /sys /root/sys
mount --move /dev /root/dev
exec switch_root /root /lib/systemd/systemd
