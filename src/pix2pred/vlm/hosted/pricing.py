"""What tokens cost, from the price list that the ``genai-prices`` package carries; nothing is fetched."""

from __future__ import annotations


def dollars(provider: str, model: str, input_tokens: int, output_tokens: int) -> float | None:
    """The price of one answer in US dollars, or ``None`` where the list does not know the model."""
    from genai_prices import Usage, calc_price

    try:
        price = calc_price(Usage(input_tokens=input_tokens, output_tokens=output_tokens), model, provider_id=provider)
    except LookupError:
        return None
    return float(price.total_price)
