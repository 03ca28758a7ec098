"""What tokens cost, from the price list that the ``genai-prices`` package carries; nothing is fetched."""

from __future__ import annotations


def dollars(provider: str, model: str, input_tokens: int, output_tokens: int, cached: int = 0) -> float | None:
    """The price of one answer in US dollars, or ``None`` where the list does not know the model.

    ``cached`` of the ``input_tokens`` are read from the provider's prompt cache.
    """
    from genai_prices import Usage, calc_price

    try:
        used = Usage(input_tokens=input_tokens, output_tokens=output_tokens, cache_read_tokens=cached)
        price = calc_price(used, model, provider_id=provider)
    except LookupError:
        return None
    return float(price.total_price)
