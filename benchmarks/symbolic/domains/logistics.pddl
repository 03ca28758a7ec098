; Trucks carry packages within cities, aeroplanes between airports.
;@ skill drive 0 drive ?t ?to
;@ skill fly 0 fly ?a ?to
;@ skill load-truck 0 load-truck ?p ?t
;@ skill load-plane 0 load-plane ?p ?a
;@ skill unload-truck 0 unload-truck ?p ?t
;@ skill unload-plane 0 unload-plane ?p ?a
(define (domain logistics)
 (:requirements :strips :typing)
 (:types city place thing - object airport - place package vehicle - thing truck plane - vehicle)
 (:predicates (in-city ?l - place ?c - city) (at ?x - thing ?l - place) (in ?p - package ?v - vehicle))
 (:action drive
  :parameters (?t - truck ?from ?to - place ?c - city)
  :precondition (and (at ?t ?from) (in-city ?from ?c) (in-city ?to ?c))
  :effect (and (at ?t ?to) (not (at ?t ?from))))
 (:action fly
  :parameters (?a - plane ?from ?to - airport)
  :precondition (and (at ?a ?from))
  :effect (and (at ?a ?to) (not (at ?a ?from))))
 (:action load-truck
  :parameters (?p - package ?t - truck ?l - place)
  :precondition (and (at ?t ?l) (at ?p ?l))
  :effect (and (in ?p ?t) (not (at ?p ?l))))
 (:action load-plane
  :parameters (?p - package ?a - plane ?l - airport)
  :precondition (and (at ?a ?l) (at ?p ?l))
  :effect (and (in ?p ?a) (not (at ?p ?l))))
 (:action unload-truck
  :parameters (?p - package ?t - truck ?l - place)
  :precondition (and (at ?t ?l) (in ?p ?t))
  :effect (and (at ?p ?l) (not (in ?p ?t))))
 (:action unload-plane
  :parameters (?p - package ?a - plane ?l - airport)
  :precondition (and (at ?a ?l) (in ?p ?a))
  :effect (and (at ?p ?l) (not (in ?p ?a)))))
