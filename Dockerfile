# docker build --build-arg ARCSLIP_COMMIT=$(git rev-parse HEAD) --tag arcslip .
FROM rust:1.95-bookworm AS build
WORKDIR /arcslip
COPY . .
# What `arcslip --version` names; the repository is not part of the build.
ARG ARCSLIP_COMMIT
RUN ARCSLIP_COMMIT=$ARCSLIP_COMMIT cargo build --release

FROM debian:bookworm-slim
RUN useradd --system --uid 10001 --no-create-home arcslip && install --directory --owner=arcslip /data
COPY --from=build /arcslip/target/release/arcslip /usr/local/bin/arcslip
USER arcslip
VOLUME /data
# Others reach this address: give ARCSLIP_TOKENS_FILE, or ARCSLIP_OPEN=true.
ENV ARCSLIP_DATABASE=/data/arcslip.db ARCSLIP_LISTEN=0.0.0.0:8080
EXPOSE 8080
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=15s --timeout=6s --start-period=10s CMD ["arcslip", "health"]
ENTRYPOINT ["arcslip"]
CMD ["serve"]
