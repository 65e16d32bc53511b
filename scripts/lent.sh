# What a chroot in which a wheel is tried is lent of this machine. Sourced: check_wheel.sh, check_arm.sh.

lend() { # the network's settings
    cp /etc/resolv.conf "$1/etc/resolv.conf"
    for file in /etc/pip.conf "${PIP_CERT:-/etc/ssl/certs/ca-certificates.crt}"; do
        [ ! -f "$file" ] || { mkdir -p "$1$(dirname "$file")" && cp "$file" "$1$file"; }
    done
}

example() { # README's Python block that makes a scene
    awk '/^```/ { if (inside && text ~ /tides\.Scene\(\)/) printf "%s", text; inside = $0 == "```python"; text = ""; next }
         inside { text = text $0 "\n" }' README.md
}

# the environment's part
settings() { env | grep -E '^(SECONDS_ALLOWED=|PIP_|https?_proxy=|HTTPS?_PROXY=|no_proxy=|NO_PROXY=)' | grep -v '^PIP_FIND_LINKS=' || true; }
