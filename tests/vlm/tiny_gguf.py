"""A model of random weights that sees pictures, as two files of llama.cpp, and its server.

    python tests/vlm/tiny_gguf.py FOLDER PORT

The answers mean nothing; the protocol, the context limit, log-probabilities and grammars are llama.cpp's own.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from gguf import GGUFWriter, TokenType
from numpy.typing import NDArray

WIDTH, HIDDEN, HEADS, LAYERS = 32, 64, 2, 2
SIDE, PATCH = 56, 14
TEMPLATE = "{% for m in messages %}{{ m['role'] }}: {{ m['content'] }}\n{% endfor %}assistant:"


def weights(*shape: int) -> NDArray[np.float32]:
    return np.random.default_rng(list(shape)).normal(0, 0.3, shape).astype(np.float32)


ONES, ZEROS = np.ones(WIDTH, dtype=np.float32), np.zeros(WIDTH, dtype=np.float32)


def language(path: Path) -> None:
    """Two blocks of a Llama, over bytes and ASCII characters."""
    model = GGUFWriter(path, "llama")
    model.add_name("tiny")
    model.add_context_length(4096)
    model.add_embedding_length(WIDTH)
    model.add_feed_forward_length(HIDDEN)
    model.add_block_count(LAYERS)
    model.add_head_count(HEADS)
    model.add_head_count_kv(HEADS)
    model.add_layer_norm_rms_eps(1e-5)
    model.add_rope_dimension_count(WIDTH // HEADS)
    tokens = ["<unk>", "<s>", "</s>", *(f"<0x{b:02X}>" for b in range(256)), *(chr(c) for c in range(32, 127))]
    kinds = [TokenType.UNKNOWN, TokenType.CONTROL, TokenType.CONTROL, *[TokenType.BYTE] * 256, *[TokenType.NORMAL] * 95]
    tokens = [t if t != " " else "\u2581" for t in tokens]
    model.add_vocab_size(len(tokens))
    model.add_tokenizer_model("llama")
    model.add_token_list(tokens)
    model.add_token_scores([-float(i) for i in range(len(tokens))])
    model.add_token_types(kinds)
    model.add_bos_token_id(1)
    model.add_eos_token_id(2)
    model.add_unk_token_id(0)
    model.add_chat_template(TEMPLATE)
    model.add_tensor("token_embd.weight", weights(len(tokens), WIDTH))
    model.add_tensor("output_norm.weight", ONES)
    model.add_tensor("output.weight", weights(len(tokens), WIDTH))
    for n in range(LAYERS):
        b = f"blk.{n}."
        model.add_tensor(b + "attn_norm.weight", ONES)
        model.add_tensor(b + "ffn_norm.weight", ONES)
        for name in ("attn_q", "attn_k", "attn_v", "attn_output"):
            model.add_tensor(f"{b}{name}.weight", weights(WIDTH, WIDTH))
        model.add_tensor(b + "ffn_gate.weight", weights(HIDDEN, WIDTH))
        model.add_tensor(b + "ffn_up.weight", weights(HIDDEN, WIDTH))
        model.add_tensor(b + "ffn_down.weight", weights(WIDTH, HIDDEN))
    _write(model)


def sight(path: Path) -> None:
    """Patches, two blocks and two projections, in the shape of LLaVA."""
    eyes = GGUFWriter(path, "clip")
    eyes.add_file_type(0)
    eyes.add_bool("clip.has_vision_encoder", True)
    eyes.add_string("clip.projector_type", "mlp")
    eyes.add_bool("clip.use_gelu", False)
    for name, number in {
        "image_size": SIDE,
        "patch_size": PATCH,
        "embedding_length": WIDTH,
        "feed_forward_length": HIDDEN,
        "projection_dim": WIDTH,
        "attention.head_count": HEADS,
        "block_count": 2,
    }.items():
        eyes.add_uint32(f"clip.vision.{name}", number)
    eyes.add_float32("clip.vision.attention.layer_norm_epsilon", 1e-5)
    eyes.add_array("clip.vision.image_mean", [0.5, 0.5, 0.5])
    eyes.add_array("clip.vision.image_std", [0.5, 0.5, 0.5])
    eyes.add_tensor("v.class_embd", weights(WIDTH))
    eyes.add_tensor("v.patch_embd.weight", weights(WIDTH, 3, PATCH, PATCH))
    eyes.add_tensor("v.position_embd.weight", weights((SIDE // PATCH) ** 2 + 1, WIDTH))
    eyes.add_tensor("v.pre_ln.weight", ONES)
    eyes.add_tensor("v.pre_ln.bias", ZEROS)
    for n in range(2):
        b = f"v.blk.{n}."
        for name in ("ln1", "ln2"):
            eyes.add_tensor(f"{b}{name}.weight", ONES)
            eyes.add_tensor(f"{b}{name}.bias", ZEROS)
        for name in ("attn_q", "attn_k", "attn_v", "attn_out"):
            eyes.add_tensor(f"{b}{name}.weight", weights(WIDTH, WIDTH))
            eyes.add_tensor(f"{b}{name}.bias", ZEROS)
        eyes.add_tensor(b + "ffn_up.weight", weights(HIDDEN, WIDTH))
        eyes.add_tensor(b + "ffn_up.bias", np.zeros(HIDDEN, dtype=np.float32))
        eyes.add_tensor(b + "ffn_down.weight", weights(WIDTH, HIDDEN))
        eyes.add_tensor(b + "ffn_down.bias", ZEROS)
    for n in (0, 2):
        eyes.add_tensor(f"mm.{n}.weight", weights(WIDTH, WIDTH))
        eyes.add_tensor(f"mm.{n}.bias", ZEROS)
    _write(eyes)


def _write(writer: Any) -> None:
    writer.write_header_to_file()
    writer.write_kv_data_to_file()
    writer.write_tensors_to_file()
    writer.close()


def serve(folder: Path, port: int) -> None:
    """Build the files and serve them until killed."""
    import xllamacpp

    language(folder / "tiny.gguf")
    sight(folder / "eyes.gguf")
    params = xllamacpp.CommonParams()
    params.model.path, params.mmproj.path = str(folder / "tiny.gguf"), str(folder / "eyes.gguf")
    params.hostnames, params.port = ["127.0.0.1"], port
    params.n_ctx, params.n_parallel, params.cpuparams.n_threads = 4096, 1, 1
    params.use_jinja, params.warmup = True, False
    server = xllamacpp.Server(params)
    print(server.listening_address, flush=True)
    while True:
        time.sleep(60)


if __name__ == "__main__":
    serve(Path(sys.argv[1]), int(sys.argv[2]))
