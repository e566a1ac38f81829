# The service as an image: `make image`; docs/container.md tells how to run it.
#
# Compiled code is baked in for a fixed kind of processor and not for the one of the build machine. The cache
# is only read at run time, so the root may be read-only and the user any. CPU=generic suits every machine of
# the architecture, also where x86-64-v3 (AVX2, since 2013) does not exist.
ARG BASE=python:3.12-slim

FROM ${BASE} AS build

WORKDIR /build
RUN python3 -m venv /app

# Dependencies change less often than the code: their layer needs only what names them.
# A machine that takes its packages from a mirror hands its pip configuration over as the secret `pip.conf`.
COPY pyproject.toml constraints.txt ./
ENV PIP_CONSTRAINT=/build/constraints.txt PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_CACHE_DIR=1
RUN --mount=type=secret,id=pip.conf,target=/etc/pip.conf \
    mkdir estimators service && touch README.md LICENSE && /app/bin/pip install '.[service,rinex]'

COPY README.md LICENSE ./
COPY estimators ./estimators
COPY service ./service
RUN --mount=type=secret,id=pip.conf,target=/etc/pip.conf \
    /app/bin/pip install --no-deps --force-reinstall . \
    && /app/bin/pip uninstall --yes pip setuptools \
    && find /app -type d -path '*-packages/*/tests' -not -path '*/numpy/*' -prune -exec rm -r {} +

ARG CPU=x86-64-v3
# Features are set and empty: without that numba adds those of the build machine to the named processor.
ENV NUMBA_CPU_NAME=${CPU} NUMBA_CPU_FEATURES= PLUMBLINE_CACHE_DIR=/app/kernels
RUN /app/bin/plumbline warm
COPY deploy/check_kernels.py deploy/check_health.py /app/deploy/
# Nobody may write here at run time, so bytecode that looks outdated would be compiled at every start.
RUN /app/bin/python -m compileall -q --invalidation-mode unchecked-hash -f /app/lib/python3.*/site-packages /app/deploy


FROM ${BASE}

# Some bases come without the bytecode of the standard library.
RUN python3 -c 'import compileall, re, sysconfig; \
    compileall.compile_dir(sysconfig.get_path("stdlib"), quiet=2, rx=re.compile("/(test|idlelib|lib2to3)/"))'

COPY --from=build /app /app

ARG CPU=x86-64-v3
# HOME and MPLCONFIGDIR are where matplotlib may write; /tmp is the one place that has to be writable.
ENV PATH=/app/bin:$PATH \
    NUMBA_CPU_NAME=${CPU} \
    NUMBA_CPU_FEATURES= \
    PLUMBLINE_CACHE_DIR=/app/kernels \
    PLUMBLINE_HOST=0.0.0.0 \
    PLUMBLINE_PORT=8000 \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1 \
    HOME=/tmp \
    MPLCONFIGDIR=/tmp/matplotlib

LABEL org.opencontainers.image.title="Plumbline" \
      org.opencontainers.image.description="Robust trends from contaminated measurements." \
      org.opencontainers.image.licenses="Apache-2.0"

# A number: orchestrators can then tell that it is not root. Any other user will do.
USER 10001:10001
WORKDIR /tmp

# The build fails here if a start would have to compile anything.
RUN ["python", "/app/deploy/check_kernels.py"]

EXPOSE 8000
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=10s --timeout=3s --start-period=15s --retries=3 \
    CMD ["python", "/app/deploy/check_health.py"]
ENTRYPOINT ["plumbline"]
CMD ["serve"]
