# Core:        docker build -t pix2pred .
# Simulators:  docker build -t pix2pred:sim --build-arg EXTRAS=sim .
# Run:         docker run --rm -v "$PWD:/work" pix2pred demo
FROM python:3.12-slim
ARG EXTRAS=""
RUN apt-get update && apt-get install -y --no-install-recommends libegl1 libgl1 libosmesa6 && rm -rf /var/lib/apt/lists/*
COPY pyproject.toml constraints.txt README.md LICENSE /src/
COPY src /src/src
RUN pip install --no-cache-dir -c /src/constraints.txt "/src${EXTRAS:+[$EXTRAS]}"
RUN useradd --create-home person
USER person
ENV MUJOCO_GL=osmesa
WORKDIR /work
ENTRYPOINT ["pix2pred"]
CMD ["--help"]
